// The whole text of an input.
#pragma once
#include <filesystem>
#include <string>

namespace pneuservo {

/// The text of a file, or of a pipe to its end; `expected` says what the file should be. Throws InputError, also where
/// the text is compressed or does not end.
std::string read_input_text(const std::filesystem::path& file, const std::string& expected);

}  // namespace pneuservo
