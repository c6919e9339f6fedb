// CANopen's own frames (CiA 301): network management, SYNC, heartbeat, emergency; pure functions on frames.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "can/frame.hpp"

namespace pneuservo {

/// Function codes; a node's identifier is added (CiA 301, predefined connection set).
inline constexpr std::uint32_t cob_nmt = 0x000, cob_sync = 0x080, cob_emergency = 0x080, cob_sdo_answer = 0x580,
                               cob_sdo_request = 0x600, cob_heartbeat = 0x700;
/// Bit of a process data object's identifier: the object is off.
inline constexpr std::uint32_t pdo_off = 0x80000000u;
/// Of process data object 1 to 4: what a node sends, and what it receives.
constexpr std::uint32_t cob_transmit_pdo(std::uint32_t pdo, std::uint32_t node) { return 0x80 + 0x100 * pdo + node; }
constexpr std::uint32_t cob_receive_pdo(std::uint32_t pdo, std::uint32_t node) { return 0x100 + 0x100 * pdo + node; }

/// Commands of the network master.
enum class NmtCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  enter_pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82,
};
/// States as a heartbeat tells them.
enum class NmtState : std::uint8_t { boot_up = 0x00, stopped = 0x04, operational = 0x05, pre_operational = 0x7F };
std::string_view nmt_state_word(NmtState state);

struct NmtOrder {
  NmtCommand command;
  std::uint8_t node;  ///< 0: all
};
struct Heartbeat {
  std::uint8_t node;
  NmtState state;
};
/// A node's answer to a guard request. The toggle bit changes from answer to answer.
struct GuardAnswer {
  std::uint8_t node;
  NmtState state;
  bool toggle;
};
/// Emergency object: code 0 with register 0 says that the error is gone.
struct Emergency {
  std::uint8_t node = 0;
  std::uint16_t code = 0;
  std::uint8_t error_register = 0;
};
/// Objects of node guarding: how often the master asks [ms], and after so many times without a request it is lost.
inline constexpr std::uint16_t guard_time = 0x100C, life_time_factor = 0x100D;
/// A node's emergency when a heartbeat that it watches (0x1016) is missing.
inline constexpr std::uint16_t emergency_heartbeat_lost = 0x8130;
/// What an emergency code's class means (CiA 301, table of error code classes).
std::string_view emergency_class_word(std::uint16_t code);

/// The bits of an error register (0x1001) in words.
std::string error_register_words(std::uint8_t error_register);
/// "emergency 0x5000 (device hardware), error register 0x81 (generic, manufacturer)".
std::string emergency_text(const Emergency& emergency);

CanFrame nmt_frame(NmtCommand command, std::uint8_t node) noexcept;
CanFrame sync_frame() noexcept;
CanFrame heartbeat_frame(std::uint8_t node, NmtState state) noexcept;
CanFrame emergency_frame(const Emergency& emergency) noexcept;
/// Node guarding: the remote request, and what the node answers.
CanFrame guard_request_frame(std::uint8_t node) noexcept;
CanFrame guard_answer_frame(const GuardAnswer& answer) noexcept;

/// Empty for every frame that is not exactly such an object: wrong identifier, length, unknown command or state.
std::optional<NmtOrder> parse_nmt(const CanFrame& frame) noexcept;
std::optional<Heartbeat> parse_heartbeat(const CanFrame& frame) noexcept;
std::optional<GuardAnswer> parse_guard_answer(const CanFrame& frame) noexcept;
bool is_guard_request(const CanFrame& frame, std::uint8_t node) noexcept;
std::optional<Emergency> parse_emergency(const CanFrame& frame) noexcept;
bool is_sync(const CanFrame& frame) noexcept;
/// Neither error, remote request nor 29 bits: what CANopen objects travel in.
bool is_plain(const CanFrame& frame) noexcept;

/// Little-endian numbers in a frame's bytes, as all of CANopen has them.
void put_u16(std::uint8_t* at, std::uint16_t value) noexcept;
void put_u32(std::uint8_t* at, std::uint32_t value) noexcept;
std::uint16_t get_u16(const std::uint8_t* at) noexcept;
std::uint32_t get_u32(const std::uint8_t* at) noexcept;

}  // namespace pneuservo
