// What ends a motion: one bit a cause, latched by the loop, recorded in every row, said in words.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace pneuservo {

/// Causes of a fault. Several may stand at once; the first tick's bits are the reason, later ones are added.
enum Fault : std::uint32_t {
  fault_position_missing = 1u << 0,
  fault_position_jump = 1u << 1,
  fault_position_range = 1u << 2,
  fault_position_frozen = 1u << 3,
  fault_speed = 1u << 4,
  fault_port_pressure_1_missing = 1u << 5,
  fault_port_pressure_2_missing = 1u << 6,
  fault_port_pressure_1_frozen = 1u << 7,
  fault_port_pressure_2_frozen = 1u << 8,
  fault_chamber_pressure_1_missing = 1u << 9,
  fault_chamber_pressure_2_missing = 1u << 10,
  fault_chamber_pressure_1_frozen = 1u << 11,
  fault_chamber_pressure_2_frozen = 1u << 12,
  fault_estimate_invalid = 1u << 13,
  fault_command_not_finite = 1u << 14,
  fault_output_missed = 1u << 15,
  fault_port_pressure_1_jump = 1u << 16,
  fault_port_pressure_2_jump = 1u << 17,
  fault_chamber_pressure_1_jump = 1u << 18,
  fault_chamber_pressure_2_jump = 1u << 19,
  fault_bus_off = 1u << 20,
  fault_link_down = 1u << 21,
  fault_node_lost = 1u << 22,
  fault_node_emergency = 1u << 23,
};

/// The faults that devices report themselves, bit by bit as in DeviceFault (hal/channel.hpp).
inline constexpr unsigned device_fault_shift = 20;
inline constexpr std::uint32_t device_fault_mask = 0xFu << device_fault_shift;

/// A fault in words: what it means and, after the colon, what to do about it.
struct FaultText {
  std::uint32_t bit;
  std::string_view name;
  std::string_view meaning;
};
inline constexpr std::array<FaultText, 24> fault_texts{{
    {fault_position_missing, "position_missing",
     "the position was missing, not a number or out of range for three ticks: check encoder, cable and supply"},
    {fault_position_jump, "position_jump",
     "the position jumped faster than twice limits.speed_mps for three ticks: check the encoder's count and shield"},
    {fault_position_range, "position_range",
     "the position is beyond the end stop by more than limits.position_margin_m: check the encoder's zero and "
     "scale"},
    {fault_position_frozen, "position_frozen",
     "the position stopped from one tick to the next, or did not change at all while the reference went on: check "
     "the encoder, and whether the slider is blocked or without air"},
    {fault_speed, "speed",
     "the measured speed is above limits.speed_mps: lower gains or reference, or raise the limit"},
    {fault_port_pressure_1_missing, "port_pressure_1_missing",
     "port pressure 1 was missing, not a number or impossible for three ticks: check sensor, cable and range"},
    {fault_port_pressure_2_missing, "port_pressure_2_missing",
     "port pressure 2 was missing, not a number or impossible for three ticks: check sensor, cable and range"},
    {fault_port_pressure_1_frozen, "port_pressure_1_frozen",
     "port pressure 1 repeats one value, which sensors.port_pressure.noise_Pa rules out: check sensor and "
     "converter, or declare a smaller noise"},
    {fault_port_pressure_2_frozen, "port_pressure_2_frozen",
     "port pressure 2 repeats one value, which sensors.port_pressure.noise_Pa rules out: check sensor and "
     "converter, or declare a smaller noise"},
    {fault_chamber_pressure_1_missing, "chamber_pressure_1_missing",
     "chamber pressure 1 was missing, not a number or impossible for three ticks: check sensor, cable and range"},
    {fault_chamber_pressure_2_missing, "chamber_pressure_2_missing",
     "chamber pressure 2 was missing, not a number or impossible for three ticks: check sensor, cable and range"},
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
}};

}  // namespace pneuservo
