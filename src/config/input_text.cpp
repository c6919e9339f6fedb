// The whole text of an input, in bounded memory.
#include "config/input_text.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "config/config_tree.hpp"

namespace pneuservo {

std::string read_input_text(const std::filesystem::path& file, const std::string& expected_file) {
  constexpr std::size_t largest_bytes = 1 << 26;  // a million waypoints; a device that never ends is told from a file
  const std::string name = file.string();
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) refuse(name, "(file)", "a folder", expected_file);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  const auto unreadable = [] { return fmt::format("an unreadable file ({})", std::strerror(errno)); };
  if (!stream) refuse(name, "(file)", errno == ENOENT ? "no such file" : unreadable(), expected_file);
  std::string text;
  std::array<char, 1 << 16> part{};
  while (stream.read(part.data(), part.size()) || stream.gcount() > 0) {
    text.append(part.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > largest_bytes)
      refuse(name, "(file)", fmt::format("more than {} bytes", largest_bytes), expected_file);
  }
  if (stream.bad()) refuse(name, "(file)", unreadable(), expected_file);
  if (text.starts_with("\x1f\x8b")) refuse(name + ":1", "(file)", "compressed data", expected_file);
  return text;
}

}  // namespace pneuservo
