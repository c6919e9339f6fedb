// What is said of a digital line that cannot be had, whichever version of libgpiod is asked.
#pragma once
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include <pneuservo/rig/hal_parameters.hpp>

namespace pneuservo {

[[noreturn]] inline void refuse_line(const std::string& key, const GpioLineParameters& p, const std::string& what) {
  const std::string where = p.chip.empty() ? "'" + p.line + "'" : fmt::format("'{}' of {}", p.line, p.chip);
  throw std::runtime_error(fmt::format("hal.gpio.{}: line {}: {}", key, where, what));
}
[[noreturn]] inline void refuse_chip(const std::string& key, const GpioLineParameters& p, int reason) {
  if (p.chip.empty())
    refuse_line(key, p, "no chip has a line of this name, or none may be opened (see gpioinfo, ls -l /dev/gpiochip*)");
  refuse_line(key, p, fmt::format("no such chip: {} (see gpiodetect)", std::strerror(reason)));
}
[[noreturn]] inline void refuse_request(const std::string& key, const GpioLineParameters& p, bool is_output, int reason,
                                        const char* user) {
  if (reason == EBUSY)
    refuse_line(key, p,
                fmt::format("is taken by '{}': end that, or name another line", user != nullptr ? user : "the kernel"));
  refuse_line(key, p,
              fmt::format("cannot be requested as {}: {}", is_output ? "an output" : "an input with edges",
                          std::strerror(reason)));
}
inline bool is_line_number(const GpioLineParameters& p) {
  return p.line.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace pneuservo
