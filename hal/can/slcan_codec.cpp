// CAN over a serial line in the text form of LAWICEL adapters.
#include "can/slcan_codec.hpp"

namespace pneuservo {
namespace {

constexpr char digits[] = "0123456789ABCDEF";

int digit_of(char c) noexcept {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

/// `count` hexadecimal digits from `at` on.
std::optional<std::uint32_t> number(std::string_view line, std::size_t at, std::size_t count) noexcept {
  if (at + count > line.size()) return {};
  std::uint32_t value = 0;
  for (std::size_t i = at; i < at + count; ++i) {
    const int digit = digit_of(line[i]);
    if (digit < 0) return {};
    value = value << 4 | static_cast<std::uint32_t>(digit);
  }
  return value;
}

std::optional<CanFrame> data_frame(std::string_view line) noexcept {
  CanFrame frame;
  frame.extended = line[0] == 'T' || line[0] == 'R';
  frame.remote = line[0] == 'r' || line[0] == 'R';
  const std::size_t id_digits = frame.extended ? 8 : 3;
  const auto id = number(line, 1, id_digits), length = number(line, 1 + id_digits, 1);
  if (!id || !length || *length > 8 || *id > (frame.extended ? 0x1FFFFFFFu : 0x7FFu)) return {};
  frame.id = *id;
  frame.length = static_cast<std::uint8_t>(*length);
  const std::size_t data = 2 + id_digits;
  const std::size_t bytes = frame.remote ? 0 : frame.length;
  // Adapters may append a time stamp of four digits, which is not used: it has no known zero.
  if (line.size() != data + 2 * bytes && line.size() != data + 2 * bytes + 4) return {};
  for (std::size_t i = 0; i < bytes; ++i) {
    const auto byte = number(line, data + 2 * i, 2);
    if (!byte) return {};
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  if (line.size() > data + 2 * bytes && !number(line, data + 2 * bytes, 4)) return {};
  return frame;
}

/// Bits of data[1] of a report on the controller's state (linux/can/error.h).
constexpr std::uint8_t warning_bits = 0x0C, passive_bits = 0x30;

std::optional<CanFrame> state_frame(std::string_view line) noexcept {
  if (line.size() < 2) return {};
  CanFrame frame{.length = 8, .error = true};
  switch (line[1]) {
    case 'b': frame.id = error_bus_off; return frame;
    case 'p':
    case 'w':
      frame.id = error_controller;
      frame.data[1] = line[1] == 'p' ? passive_bits : warning_bits;
      return frame;
    case 'a': frame.id = error_restarted; return frame;
    default: return {};
  }
}

}  // namespace

SlcanText slcan_text(const CanFrame& frame) noexcept {
  SlcanText out;
  const auto put = [&](char c) { out.text[out.length++] = c; };
  put(frame.remote ? (frame.extended ? 'R' : 'r') : (frame.extended ? 'T' : 't'));
  for (int shift = frame.extended ? 28 : 8; shift >= 0; shift -= 4) put(digits[frame.id >> shift & 0xF]);
  const std::size_t bytes = frame.length <= 8 ? frame.length : 8;
  put(digits[bytes]);
  for (std::size_t i = 0; i < bytes && !frame.remote; ++i) {
    put(digits[frame.data[i] >> 4]);
    put(digits[frame.data[i] & 0xF]);
  }
  put('\r');
  return out;
}

std::optional<CanFrame> slcan_frame(std::string_view line) noexcept {
  if (line.empty()) return {};
  switch (line[0]) {
    case 't':
    case 'T':
    case 'r':
    case 'R': return data_frame(line);
    case 's': return state_frame(line);
    case 'e':
      if (line.find('a', 1) == std::string_view::npos) return {};
      return CanFrame{.id = error_acknowledge, .length = 8, .error = true};
    default: return {};
  }
}

std::optional<std::string_view> SlcanLines::add(char c) noexcept {
  if (c == '\r' || c == '\a') {
    const std::string_view line(text_.data(), length_);
    const bool whole = !too_long_;
    length_ = 0;
    too_long_ = false;
    return whole ? std::optional(line) : std::nullopt;
  }
  if (length_ == text_.size()) too_long_ = true;
  else text_[length_++] = c;
  return {};
}

}  // namespace pneuservo
