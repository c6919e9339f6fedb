// Writing a result that can be made again: an older one stays until the new one is whole.
#pragma once
#include <string>

namespace pneuservo {

/// Writes a result with owner and mode of the older one that it replaces. Throws InputError where it cannot.
void write_result(const std::string& path, const std::string& text);

}  // namespace pneuservo
