// How a config may name a chip: what the lookup of libgpiod 1 takes, for version 2, which has none.
#pragma once
#include <string>
#include <string_view>

namespace pneuservo {

/// Opened itself: links of udev stand in folders of their own.
inline bool is_chip_path(const std::string& chip) noexcept { return chip.find('/') != std::string::npos; }

/// Whether `chip` means the one of this name ("gpiochip0") and label, by name, number or label.
inline bool is_chip_named(const std::string& chip, std::string_view name, std::string_view label) {
  return chip == name || "gpiochip" + chip == name || chip == label;
}

}  // namespace pneuservo
