// The state machine of a drive (CiA 402-2, power drive systems): states, the commands of a controlword, and what leads
// where.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace pneuservo {

enum class DriveState : std::uint8_t {
  not_ready_to_switch_on,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,  ///< alone lets the axis move
  quick_stop_active,
  fault_reaction_active,
  fault,
};
inline constexpr std::array<std::string_view, 8> drive_state_names{
    "not ready to switch on", "switch on disabled", "ready to switch on",    "switched on",
    "operation enabled",      "quick stop active",  "fault reaction active", "fault"};

/// Bits of the controlword (0x6040) and of the statusword (0x6041); those of a mode stand in DriveNode.
inline constexpr std::uint16_t control_new_set_point = 0x0010, control_change_immediately = 0x0020,
                               control_relative = 0x0040, control_fault_reset = 0x0080, control_halt = 0x0100;
inline constexpr std::uint16_t status_voltage_enabled = 0x0010, status_warning = 0x0080, status_remote = 0x0200,
                               status_target_reached = 0x0400, status_internal_limit = 0x0800, status_of_mode = 0x1000,
                               status_error_of_mode = 0x2000;

/// Bits 0 to 3, 5 and 6 of the statusword.
constexpr std::uint16_t status_bits(DriveState state) noexcept {
  constexpr std::array<std::uint16_t, 8> bits{0x00, 0x40, 0x21, 0x23, 0x27, 0x07, 0x0F, 0x08};
  return bits[static_cast<std::size_t>(state)];
}

/// What bits 0 to 3 of a controlword ask for. `switch_on` also disables an enabled operation.
enum class DriveCommand : std::uint8_t { disable_voltage, quick_stop, shutdown, switch_on, enable_operation };

constexpr DriveCommand command_of(std::uint16_t controlword) noexcept {
  if ((controlword & 0x2) == 0) return DriveCommand::disable_voltage;
  if ((controlword & 0x4) == 0) return DriveCommand::quick_stop;
  if ((controlword & 0x1) == 0) return DriveCommand::shutdown;
  return (controlword & 0x8) == 0 ? DriveCommand::switch_on : DriveCommand::enable_operation;
}

/// The state that a command leads to; a command that means nothing in a state leaves it. Faults are left by the edge of
/// bit 7 alone. A controlword that enables where the drive is only ready switches on on its way.
constexpr DriveState commanded_state(DriveState state, DriveCommand command) noexcept {
  using S = DriveState;
  const bool is_up = state == S::ready_to_switch_on || state == S::switched_on || state == S::operation_enabled;
  switch (command) {
    case DriveCommand::disable_voltage: return is_up || state == S::quick_stop_active ? S::switch_on_disabled : state;
    case DriveCommand::quick_stop:
      if (state == S::operation_enabled) return S::quick_stop_active;
      return is_up ? S::switch_on_disabled : state;
    case DriveCommand::shutdown: return is_up || state == S::switch_on_disabled ? S::ready_to_switch_on : state;
    case DriveCommand::switch_on: return is_up ? S::switched_on : state;
    case DriveCommand::enable_operation: return is_up || state == S::quick_stop_active ? S::operation_enabled : state;
  }
  return state;
}

}  // namespace pneuservo
