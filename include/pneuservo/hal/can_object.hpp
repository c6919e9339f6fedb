// An entry of a CANopen PDO mapping, written as device manuals write it: 0x60200120 is index 0x6020, sub-index 1, 32
// bits.
#pragma once
#include <cstdint>

namespace pneuservo {

/// Index in the upper 16 bits, sub-index in the next 8, length in bits in the lowest 8.
struct CanObject {
  std::uint32_t word = 0;

  constexpr std::uint16_t index() const noexcept { return static_cast<std::uint16_t>(word >> 16); }
  constexpr std::uint8_t sub() const noexcept { return static_cast<std::uint8_t>(word >> 8); }
  constexpr unsigned bits() const noexcept { return word & 0xFF; }
  friend constexpr bool operator==(const CanObject&, const CanObject&) = default;
};

}  // namespace pneuservo
