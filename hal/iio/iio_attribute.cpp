// One attribute of a device of the kernel's Industrial I/O.
#include "iio/iio_attribute.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <pneuservo/core/rt.hpp>

namespace pneuservo {
namespace {

constexpr std::size_t longest_number = 32;  // the kernel prints at most 20 digits, a sign and 9 decimals

}  // namespace

// Not from_chars of a double: some libraries allocate in it.
std::optional<double> iio_number(std::string_view text) noexcept {
  const bool is_negative = text.starts_with('-');
  if (is_negative) text.remove_prefix(1);
  if (text.empty() || text.front() < '0' || text.front() > '9') return {};
  double value = 0.0, unit = 1.0;
  bool is_fraction = false;
  for (const char c : text) {
    if (c == '.' && !is_fraction) {
      is_fraction = true;
      continue;
    }
    if (c < '0' || c > '9') break;
    value = value * 10.0 + (c - '0');
    if (is_fraction) unit *= 10.0;
  }
  return (is_negative ? -value : value) / unit;
}

IioAttribute::IioAttribute(const std::string& path, bool is_output)
    : file_(open(path.c_str(), (is_output ? O_RDWR : O_RDONLY) | O_CLOEXEC)) {
  if (file_ < 0) throw std::system_error(errno, std::generic_category(), path);
}

IioAttribute::~IioAttribute() {
  if (file_ >= 0) close(file_);
}

IioAttribute::IioAttribute(IioAttribute&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

std::optional<double> IioAttribute::read() const noexcept {
  std::array<char, longest_number> text{};
  const RtAllow reviewed;
  const ssize_t size = pread(file_, text.data(), text.size(), 0);
  if (size <= 0) return {};
  return iio_number({text.data(), static_cast<std::size_t>(size)});
}

bool IioAttribute::write(std::int64_t code) const noexcept {
  std::array<char, longest_number> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), code);
  if (error != std::errc{}) return false;
  const auto size = static_cast<std::size_t>(end - text.data());
  const RtAllow reviewed;
  return pwrite(file_, text.data(), size, 0) == static_cast<ssize_t>(size);
}

}  // namespace pneuservo
