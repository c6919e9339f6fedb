// CANopen's own frames: network management, SYNC, heartbeat, emergency.
#include "can/canopen.hpp"

#include <array>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pneuservo {
namespace {

constexpr std::uint8_t toggle_bit = 0x80;

constexpr bool is_node(std::uint32_t node) { return node >= 1 && node <= 127; }

bool is_command(std::uint8_t byte) noexcept {
  switch (static_cast<NmtCommand>(byte)) {
    case NmtCommand::start:
    case NmtCommand::stop:
    case NmtCommand::enter_pre_operational:
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication: return true;
  }
  return false;
}

bool is_state(std::uint8_t byte) noexcept {
  switch (static_cast<NmtState>(byte)) {
    case NmtState::boot_up:
    case NmtState::stopped:
    case NmtState::operational:
    case NmtState::pre_operational: return true;
  }
  return false;
}

}  // namespace

std::string_view nmt_state_word(NmtState state) {
  switch (state) {
    case NmtState::boot_up: return "boot-up";
    case NmtState::stopped: return "stopped";
    case NmtState::operational: return "operational";
    case NmtState::pre_operational: return "pre-operational";
  }
  return "unknown";
}

std::string_view emergency_class_word(std::uint16_t code) {
  switch (code >> 8) {
    case 0x00: return "error reset or no error";
    case 0x10: return "generic error";
    case 0x20:
    case 0x21:
    case 0x22:
    case 0x23: return "current";
    case 0x30:
    case 0x31:
    case 0x32:
    case 0x33: return "voltage";
    case 0x40:
    case 0x41:
    case 0x42: return "temperature";
    case 0x50: return "device hardware";
    case 0x60:
    case 0x61:
    case 0x62:
    case 0x63: return "device software";
    case 0x70: return "additional modules";
    case 0x80: return "monitoring";
    case 0x81: return "communication";
    case 0x82: return "protocol";
    case 0x90: return "external error";
    case 0xF0: return "additional functions";
    default: return (code >> 8) == 0xFF ? "device specific" : "unknown class";
  }
}

void put_u16(std::uint8_t* at, std::uint16_t value) noexcept {
  at[0] = static_cast<std::uint8_t>(value);
  at[1] = static_cast<std::uint8_t>(value >> 8);
}
void put_u32(std::uint8_t* at, std::uint32_t value) noexcept {
  put_u16(at, static_cast<std::uint16_t>(value));
  put_u16(at + 2, static_cast<std::uint16_t>(value >> 16));
}
std::uint16_t get_u16(const std::uint8_t* at) noexcept { return static_cast<std::uint16_t>(at[0] | at[1] << 8); }
std::uint32_t get_u32(const std::uint8_t* at) noexcept {
  return get_u16(at) | static_cast<std::uint32_t>(get_u16(at + 2)) << 16;
}

std::string error_register_words(std::uint8_t error_register) {
  constexpr std::array words{"generic",       "current",        "voltage",  "temperature",
                             "communication", "device profile", "reserved", "manufacturer"};
  std::vector<std::string_view> set;
  for (std::size_t bit = 0; bit < words.size(); ++bit)
    if ((error_register >> bit & 1) != 0) set.emplace_back(words[bit]);
  return fmt::format("{}", fmt::join(set, ", "));
}

std::string emergency_text(const Emergency& emergency) {
  return fmt::format("emergency 0x{:04x} ({}), error register 0x{:02x} ({})", emergency.code,
                     emergency_class_word(emergency.code), emergency.error_register,
                     error_register_words(emergency.error_register));
}

CanFrame nmt_frame(NmtCommand command, std::uint8_t node) noexcept {
  return {.id = cob_nmt, .length = 2, .data = {static_cast<std::uint8_t>(command), node}};
}

CanFrame sync_frame() noexcept { return {.id = cob_sync}; }

CanFrame heartbeat_frame(std::uint8_t node, NmtState state) noexcept {
  return {.id = cob_heartbeat + node, .length = 1, .data = {static_cast<std::uint8_t>(state)}};
}

CanFrame emergency_frame(const Emergency& emergency) noexcept {
  CanFrame frame{.id = cob_emergency + emergency.node, .length = 8};
  put_u16(frame.data.data(), emergency.code);
  frame.data[2] = emergency.error_register;
  return frame;
}

CanFrame guard_request_frame(std::uint8_t node) noexcept {
  return {.id = cob_heartbeat + node, .length = 1, .remote = true};
}

CanFrame guard_answer_frame(const GuardAnswer& answer) noexcept {
  CanFrame frame = heartbeat_frame(answer.node, answer.state);
  if (answer.toggle) frame.data[0] |= toggle_bit;
  return frame;
}

bool is_plain(const CanFrame& frame) noexcept {
  return !frame.error && !frame.remote && !frame.extended && frame.id <= 0x7FF && frame.length <= 8;
}

std::optional<NmtOrder> parse_nmt(const CanFrame& frame) noexcept {
  if (!is_plain(frame) || frame.id != cob_nmt || frame.length != 2 || frame.data[1] > 127) return {};
  if (!is_command(frame.data[0])) return {};
  return NmtOrder{static_cast<NmtCommand>(frame.data[0]), frame.data[1]};
}

std::optional<Heartbeat> parse_heartbeat(const CanFrame& frame) noexcept {
  const auto answer = parse_guard_answer(frame);
  if (!answer || answer->toggle) return {};
  return Heartbeat{answer->node, answer->state};
}

std::optional<GuardAnswer> parse_guard_answer(const CanFrame& frame) noexcept {
  if (!is_plain(frame) || frame.length != 1 || !is_node(frame.id - cob_heartbeat)) return {};
  const auto state = static_cast<std::uint8_t>(frame.data[0] & ~toggle_bit);
  if (!is_state(state)) return {};
  return GuardAnswer{static_cast<std::uint8_t>(frame.id - cob_heartbeat), static_cast<NmtState>(state),
                     (frame.data[0] & toggle_bit) != 0};
}

bool is_guard_request(const CanFrame& frame, std::uint8_t node) noexcept {
  return frame.remote && !frame.error && !frame.extended && frame.id == cob_heartbeat + node;
}

std::optional<Emergency> parse_emergency(const CanFrame& frame) noexcept {
  if (!is_plain(frame) || frame.length != 8 || !is_node(frame.id - cob_emergency)) return {};
  return Emergency{static_cast<std::uint8_t>(frame.id - cob_emergency), get_u16(frame.data.data()), frame.data[2]};
}

bool is_sync(const CanFrame& frame) noexcept {
  // A SYNC may carry a counter of one byte (CiA 301, 0x1019).
  return is_plain(frame) && frame.id == cob_sync && frame.length <= 1;
}

}  // namespace pneuservo
