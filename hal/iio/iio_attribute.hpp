// One attribute of a device of the kernel's Industrial I/O, held open: libiio's own calls open it anew each time.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pneuservo {

/// The number that an attribute's text begins with: "-12", "1234.5". None: the text is no number.
std::optional<double> iio_number(std::string_view text) noexcept;

/// A file below /sys/bus/iio/devices whose every reading or writing is one call of the driver.
class IioAttribute {
 public:
  /// Throws std::system_error.
  IioAttribute(const std::string& path, bool is_output);
  ~IioAttribute();
  IioAttribute(IioAttribute&& other) noexcept;
  IioAttribute& operator=(IioAttribute&&) = delete;

  /// Hot. One pread; it lasts as long as the driver's conversion. None: the driver refused.
  std::optional<double> read() const noexcept;
  /// Hot, and fit for a handler of signals. One pwrite. False: the driver refused.
  bool write(std::int64_t code) const noexcept;

 private:
  int file_ = -1;
};

}  // namespace pneuservo
