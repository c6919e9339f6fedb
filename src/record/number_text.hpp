// Numbers as recordings spell them: the shortest text that reads back to the same bits.
#pragma once
#include <charconv>
#include <cmath>
#include <cstdint>

namespace pneuservo {

/// Longest spelling: -2.2250738585072014e-308.
constexpr int number_text_size = 32;

/// Writes at `text` (number_text_size long); returns the end. NaN, "no value", is the empty text.
inline char* number_text(char* text, double value) noexcept {
  if (std::isnan(value)) return text;
  return std::to_chars(text, text + number_text_size, value).ptr;
}
inline char* number_text(char* text, std::uint32_t value) noexcept {
  return std::to_chars(text, text + number_text_size, value).ptr;
}
inline char* number_text(char* text, std::uint64_t value) noexcept {
  return std::to_chars(text, text + number_text_size, value).ptr;
}

}  // namespace pneuservo
