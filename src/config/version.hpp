// The version of this build, for recordings and reports.
#pragma once
#include <string_view>

namespace pneuservo {

/// Release, e.g. "0.1.0".
std::string_view version();
/// Instruction set this build was compiled for: "x86-64" or "x86-64-v3".
std::string_view code_path();

}  // namespace pneuservo
