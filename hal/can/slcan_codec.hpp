// CAN over a serial line in the text form of LAWICEL adapters: "t1812AABB\r" is frame 0x181 with two bytes.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "can/frame.hpp"

namespace pneuservo {

/// A frame as text with its carriage return; the longest, of 29 bits, has 27 characters.
struct SlcanText {
  std::array<char, 32> text{};
  std::size_t length = 0;
  std::string_view view() const noexcept { return {text.data(), length}; }
};
SlcanText slcan_text(const CanFrame& frame) noexcept;

/// A line without its carriage return as a frame. Beside data frames adapters report bus states (sb: bus-off, sp:
/// passive, sw: warning) and errors (e1a: no acknowledge), which become error frames. Empty for anything else.
std::optional<CanFrame> slcan_frame(std::string_view line) noexcept;

/// Cuts a stream of bytes into lines; one that grows too long is dropped up to its end.
class SlcanLines {
 public:
  /// Empty until a carriage return or bell ends a line.
  std::optional<std::string_view> add(char c) noexcept;

 private:
  std::array<char, 64> text_{};
  std::size_t length_ = 0;
  bool too_long_ = false;
};

}  // namespace pneuservo
