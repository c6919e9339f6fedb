// What ends a motion: one bit a cause, latched by the loop, recorded in every row, said in words.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include <pneuservo/core/signal.hpp>

namespace pneuservo {

/// Causes of a fault. Several may stand at once; the first tick's bits are the reason, later ones are added. Bits below
/// 53 alone: recordings are read as doubles.
enum Fault : std::uint64_t {
  fault_position_missing = 1ull << 0,
  fault_position_jump = 1ull << 1,
  fault_position_range = 1ull << 2,
  fault_position_frozen = 1ull << 3,
  fault_speed = 1ull << 4,
  fault_port_pressure_1_missing = 1ull << 5,
  fault_port_pressure_2_missing = 1ull << 6,
  fault_port_pressure_1_frozen = 1ull << 7,
  fault_port_pressure_2_frozen = 1ull << 8,
  fault_chamber_pressure_1_missing = 1ull << 9,
  fault_chamber_pressure_2_missing = 1ull << 10,
  fault_chamber_pressure_1_frozen = 1ull << 11,
  fault_chamber_pressure_2_frozen = 1ull << 12,
  fault_estimate_invalid = 1ull << 13,
  fault_command_not_finite = 1ull << 14,
  fault_output_missed = 1ull << 15,
  fault_port_pressure_1_jump = 1ull << 16,
  fault_port_pressure_2_jump = 1ull << 17,
  fault_chamber_pressure_1_jump = 1ull << 18,
  fault_chamber_pressure_2_jump = 1ull << 19,
  fault_bus_off = 1ull << 20,
  fault_link_down = 1ull << 21,
  fault_node_lost = 1ull << 22,
  fault_node_emergency = 1ull << 23,
  fault_emergency_stop = 1ull << 24,
  fault_limit_switch = 1ull << 25,
  fault_valve_power = 1ull << 26,
  fault_late_tick = 1ull << 27,
  fault_pressure_limit = 1ull << 28,
  fault_supply_missing = 1ull << 29,
  fault_supply_frozen = 1ull << 30,
  fault_supply_low = 1ull << 31,
  fault_flow_mismatch_1 = 1ull << 32,
  fault_flow_mismatch_2 = 1ull << 33,
  fault_chamber_mismatch_1 = 1ull << 34,
  fault_chamber_mismatch_2 = 1ull << 35,
  fault_deviation = 1ull << 36,
  fault_stall = 1ull << 37,
  fault_end_stop = 1ull << 38,
  fault_start_motion = 1ull << 39,
  fault_position_unreliable = 1ull << 40,
  fault_pressure_unreliable = 1ull << 41,
  fault_missed_slots = 1ull << 42,
  fault_checks_rested = 1ull << 43,
  fault_suspended = 1ull << 44,
  fault_position_unknown = 1ull << 45,
  fault_double_answer = 1ull << 48,
  fault_output_unconfirmed = 1ull << 49,
  fault_guard_lost = 1ull << 50,
  fault_differential_pressure_1_missing = 1ull << 51,
  fault_differential_pressure_2_missing = 1ull << 52,
};

/// The faults of one measured channel. Sides follow each other bit by bit; no step of the supply is too large.
struct SignalFaults {
  std::uint64_t missing = 0, frozen = 0, jumped = 0;
};
constexpr SignalFaults faults_of(Signal signal) noexcept {
  const int second = info(signal).side == 2 ? 1 : 0;
  switch (info(signal).sensor) {
    case SensorKind::position: return {fault_position_missing, fault_position_frozen, fault_position_jump};
    case SensorKind::port_pressure:
      return {fault_port_pressure_1_missing << second, fault_port_pressure_1_frozen << second,
              fault_port_pressure_1_jump << second};
    case SensorKind::chamber_pressure:
      return {fault_chamber_pressure_1_missing << second, fault_chamber_pressure_1_frozen << second,
              fault_chamber_pressure_1_jump << second};
    case SensorKind::supply_pressure: return {fault_supply_missing, fault_supply_frozen, fault_supply_missing};
    // Beyond its range it repeats itself, and a valve's step reaches it at once: the cross-check tells a wrong one.
    case SensorKind::differential_pressure: return {fault_differential_pressure_1_missing << second, 0, 0};
    case SensorKind::supply_flow:  // no motion rests on it
    case SensorKind::force: break;
  }
  return {};
}

/// The faults that devices report themselves: the bits of DeviceFault (hal/channel.hpp), the first four from bit 20 on,
/// the others from bit 48 on.
constexpr std::uint64_t faults_of_devices(std::uint32_t device_faults) noexcept {
  return std::uint64_t{device_faults & 0xFu} << 20 | std::uint64_t{device_faults >> 4 & 0xFu} << 48;
}

constexpr std::uint32_t device_faults_of(std::uint64_t faults) noexcept {
  return static_cast<std::uint32_t>((faults >> 20 & 0xFu) | (faults >> 48 & 0xFu) << 4);
}

/// A fault in words: what it means and, after the colon, what to do about it.
struct FaultText {
  std::uint64_t bit;
  std::string_view name;
  std::string_view meaning;
};
inline constexpr std::array<FaultText, 51> fault_texts{{
    {fault_position_missing, "position_missing",
     "the position was missing, too old, not a number or out of range: check encoder, cable and supply"},
    {fault_position_jump, "position_jump",
     "the position jumped faster than twice limits.speed_mps for three ticks: check the encoder's count and shield"},
    {fault_position_range, "position_range",
     "the position is beyond the end stop by more than limits.position_margin_m: check the encoder's zero and "
     "scale"},
    {fault_position_frozen, "position_frozen",
     "the position stopped from one tick to the next, or did not change at all while the prediction went on: check "
     "the encoder, and whether the slider is blocked or without air"},
    {fault_speed, "speed",
     "the measured speed is above limits.speed_mps: lower gains or reference, or raise the limit"},
    {fault_port_pressure_1_missing, "port_pressure_1_missing",
     "port pressure 1 was missing, too old, not a number or impossible: check sensor, cable and range"},
    {fault_port_pressure_2_missing, "port_pressure_2_missing",
     "port pressure 2 was missing, too old, not a number or impossible: check sensor, cable and range"},
    {fault_port_pressure_1_frozen, "port_pressure_1_frozen",
     "port pressure 1 repeats one value, which sensors.port_pressure.noise_Pa rules out: check sensor and "
     "converter, or declare a smaller noise"},
    {fault_port_pressure_2_frozen, "port_pressure_2_frozen",
     "port pressure 2 repeats one value, which sensors.port_pressure.noise_Pa rules out: check sensor and "
     "converter, or declare a smaller noise"},
    {fault_chamber_pressure_1_missing, "chamber_pressure_1_missing",
     "chamber pressure 1 was missing, too old, not a number or impossible: check sensor, cable and range"},
    {fault_chamber_pressure_2_missing, "chamber_pressure_2_missing",
     "chamber pressure 2 was missing, too old, not a number or impossible: check sensor, cable and range"},
    {fault_chamber_pressure_1_frozen, "chamber_pressure_1_frozen",
     "chamber pressure 1 repeats one value, which sensors.chamber_pressure.noise_Pa rules out: check sensor and "
     "converter, or declare a smaller noise"},
    {fault_chamber_pressure_2_frozen, "chamber_pressure_2_frozen",
     "chamber pressure 2 repeats one value, which sensors.chamber_pressure.noise_Pa rules out: check sensor and "
     "converter, or declare a smaller noise"},
    {fault_estimate_invalid, "estimate_invalid",
     "the estimator had no usable port pressures or position for too long: check their sensors"},
    {fault_command_not_finite, "command_not_finite",
     "the control law gave no finite command: check controller gains and sensor scales"},
    {fault_output_missed, "output_missed",
     "the backend could not write the command: check the output's bus or card; the valve may keep its last "
     "command"},
    {fault_port_pressure_1_jump, "port_pressure_1_jump",
     "port pressure 1 jumped for three ticks by more than valve and line can do: check sensor, cable and shield"},
    {fault_port_pressure_2_jump, "port_pressure_2_jump",
     "port pressure 2 jumped for three ticks by more than valve and line can do: check sensor, cable and shield"},
    {fault_chamber_pressure_1_jump, "chamber_pressure_1_jump",
     "chamber pressure 1 jumped for three ticks by more than valve and line can do: check sensor, cable and "
     "shield"},
    {fault_chamber_pressure_2_jump, "chamber_pressure_2_jump",
     "chamber pressure 2 jumped for three ticks by more than valve and line can do: check sensor, cable and "
     "shield"},
    {fault_bus_off, "bus_off",
     "the CAN controller went bus-off, nothing is sent any more: check wiring, termination and bit rate, take the "
     "interface down and up again"},
    {fault_link_down, "link_down",
     "the bus interface went down or the adapter is gone: check cable and adapter, set the interface up again"},
    {fault_node_lost, "node_lost",
     "a node on the bus fell silent, rebooted or left the operational state: check its supply and cable"},
    {fault_node_emergency, "node_emergency",
     "a node on the bus reported an emergency: its code is told after the run, its manual explains it"},
    {fault_emergency_stop, "emergency_stop",
     "the emergency stop is pressed or its line cannot be read: release it when the danger is over, check its wire"},
    {fault_limit_switch, "limit_switch",
     "the slider ran onto a limit switch or the switch cannot be read: check reference, encoder's zero and switch"},
    {fault_valve_power, "valve_power", "the valve has no supply or its line cannot be read: switch it on, check fuse"},
    {fault_late_tick, "late_tick",
     "the loop was late by more than limits.lateness_s: see what pneuservo check says of the machine"},
    {fault_pressure_limit, "pressure_limit",
     "a pressure, measured or that of a pressure rig's volume, is above limits.pressure_Pa: check supply regulator, "
     "load and reference"},
    {fault_supply_missing, "supply_missing",
     "the supply pressure was missing, too old, not a number or impossible: check sensor, cable and range"},
    {fault_supply_frozen, "supply_frozen",
     "the supply pressure repeats one value, which sensors.supply_pressure.noise_Pa rules out: check sensor and "
     "converter, or declare a smaller noise"},
    {fault_supply_low, "supply_low",
     "the measured supply pressure is below limits.supply_share of supply.pressure_Pa: check compressor, regulator "
     "and hose"},
    {fault_flow_mismatch_1, "flow_mismatch_1",
     "the air that valve and position say went to side 1 is not in it: check valve 1, supply, leaks, port sensor 1 "
     "and encoder"},
    {fault_flow_mismatch_2, "flow_mismatch_2",
     "the air that valve and position say went to side 2 is not in it: check valve 2, supply, leaks, port sensor 2 "
     "and encoder"},
    {fault_chamber_mismatch_1, "chamber_mismatch_1",
     "measured and estimated pressure of chamber 1 differ by more than limits.chamber_mismatch_Pa: check both sensors "
     "of side 1, line 1 and the config's line_1"},
    {fault_chamber_mismatch_2, "chamber_mismatch_2",
     "measured and estimated pressure of chamber 2 differ by more than limits.chamber_mismatch_Pa: check both sensors "
     "of side 2, line 2 and the config's line_2"},
    {fault_deviation, "deviation",
     "the slider is further from the predicted motion than limits.deviation_m, or its speed than "
     "limits.speed_deviation_mps: look for an obstacle, a jam, a payload above limits.payload_max_kg, a wrong gain or "
     "a valve that does not answer"},
    {fault_stall, "stall",
     "the air pushed with more than limits.stall_force_N while the slider stood: look for what blocks it"},
    {fault_end_stop, "end_stop",
     "the slider ran onto an end stop: check reference, encoder's zero and gains, or allow it by "
     "limits.end_stop_contact"},
    {fault_start_motion, "start_motion",
     "the first motion left its prediction, or was faster than a first motion may be: check the signs of valve and "
     "encoder, both hoses and both port sensors (pneuservo commission tells which), whether the reference begins so "
     "fast, and for friction or a valve unlike the config's (pneuservo improve)"},
    {fault_position_unreliable, "position_unreliable",
     "more than limits.bad_share of the position's samples were bad: check encoder, cable and bus"},
    {fault_pressure_unreliable, "pressure_unreliable",
     "more than limits.bad_share of a pressure's samples were bad: check sensors, cables and bus"},
    {fault_missed_slots, "missed_slots",
     "the loop missed more than limits.missed_share of its slots: see what pneuservo check says of the machine"},
    {fault_checks_rested, "checks_rested",
     "the cross-checks could not watch the moving axis for longer than limits.checks_rest_s: end what makes the loop "
     "late or its inputs bad"},
    {fault_suspended, "suspended",
     "the machine was suspended while the axis was active: forbid it (systemctl mask sleep.target suspend.target)"},
    {fault_double_answer, "double_answer",
     "a device answered more than once a cycle: look for a second device with its number or a second master"},
    {fault_output_unconfirmed, "output_unconfirmed",
     "the output that the device reads back is not the one that was sent: check the device and who else commands it"},
    {fault_guard_lost, "guard_lost", "pneuservo guard does not answer: start it before the run"},
    {fault_differential_pressure_1_missing, "differential_pressure_1_missing",
     "the pressure lost along line 1 was missing, too old, not a number or beyond the sensor's range: check sensor, "
     "cable and range"},
    {fault_differential_pressure_2_missing, "differential_pressure_2_missing",
     "the pressure lost along line 2 was missing, too old, not a number or beyond the sensor's range: check sensor, "
     "cable and range"},
    {fault_position_unknown, "position_unknown",
     "without an encoder the position is known less well than position.bound_max_m, or a switch cannot be read: pass a "
     "switch more often, check both switches"},
}};

}  // namespace pneuservo
