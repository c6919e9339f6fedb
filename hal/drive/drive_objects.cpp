// The object dictionary of the axis as a drive.
#include "drive/drive_objects.hpp"

#include <algorithm>
#include <array>

#include <pneuservo/loop/fault.hpp>

#include "can/eds_text.hpp"

namespace pneuservo {
namespace {

namespace object = drive_object;

enum class Access { read, write, constant };

struct ObjectRow {
  std::uint16_t index;
  std::uint8_t sub;
  unsigned bits;
  bool is_signed;
  Access access;
  bool can_map;
  std::uint32_t value;
  const char* name;
};

constexpr std::uint32_t off = 0xFFFFFFFF;  // of a window: not watched
constexpr std::uint32_t micrometres = 0xFA010000, per_second = 0x0300, per_second_squared = 0x5700;  // CiA 303-2
constexpr std::uint32_t modes = 1u << 0 | 1u << 5 | 1u << 7;  // profile position, homing, cyclic synchronous position
/// Of the statusword's PDO beside its changes: masters that wait for the next one, and ones that come late.
constexpr std::uint32_t status_event_timer_ms = 50;
constexpr auto rw = Access::write, ro = Access::read, constant = Access::constant;

std::uint32_t raw(std::int32_t value) { return static_cast<std::uint32_t>(value); }

std::uint32_t units(double si) { return raw(to_drive_units(si)); }

std::vector<ObjectRow> rows_of(const Rig& rig) {
  const ReferenceSpec& live = rig.reference;
  const std::uint32_t speed = units(live.speed_mps), acceleration = units(live.acceleration_mps2);
  return {
      {object::faults, 0, 8, false, constant, false, 2, "Highest sub-index supported"},
      {object::faults, 1, 32, false, ro, true, 0, "Faults, bits 0 to 31"},
      {object::faults, 2, 32, false, ro, true, 0, "Faults, bits 32 to 63"},
      {object::stream_delay, 0, 32, false, ro, true, 0, "Delay of the cyclic mode in us"},
      {object::abort_option, 0, 16, true, rw, false, raw(-1) & 0xFFFF, "Abort connection option code"},
      {object::error_code, 0, 16, false, ro, true, 0, "Error code"},
      {object::controlword, 0, 16, false, rw, true, 0, "Controlword"},
      {object::statusword, 0, 16, false, ro, true, 0, "Statusword"},
      {object::quick_stop_option, 0, 16, true, rw, false, 2, "Quick stop option code"},
      {object::shutdown_option, 0, 16, true, rw, false, 0, "Shutdown option code"},
      {object::disable_option, 0, 16, true, rw, false, 1, "Disable operation option code"},
      {object::halt_option, 0, 16, true, constant, false, 1, "Halt option code"},
      {object::fault_option, 0, 16, true, constant, false, 0, "Fault reaction option code"},
      {object::mode, 0, 8, true, rw, true, 0, "Modes of operation"},
      {object::mode_display, 0, 8, true, ro, true, 0, "Modes of operation display"},
      {object::position_demand, 0, 32, true, ro, true, 0, "Position demand value"},
      {object::position_actual, 0, 32, true, ro, true, 0, "Position actual value"},
      {object::following_window, 0, 32, false, rw, true, off, "Following error window"},
      {object::following_time, 0, 16, false, rw, true, 0, "Following error time out"},
      {object::position_window, 0, 32, false, rw, true, off, "Position window"},
      {object::position_time, 0, 16, false, rw, true, 0, "Position window time"},
      {object::speed_demand, 0, 32, true, ro, true, 0, "Velocity demand value"},
      {object::speed_actual, 0, 32, true, ro, true, 0, "Velocity actual value"},
      {object::target_position, 0, 32, true, rw, true, 0, "Target position"},
      {object::home_offset, 0, 32, true, rw, false, 0, "Home offset"},
      {object::position_limit, 0, 8, false, constant, false, 2, "Highest sub-index supported"},
      {object::position_limit, 1, 32, true, ro, false, units(live.lowest_m), "Min position limit"},
      {object::position_limit, 2, 32, true, ro, false, units(live.highest_m), "Max position limit"},
      {object::most_speed, 0, 32, false, constant, false, speed, "Max profile velocity"},
      {object::profile_speed, 0, 32, false, rw, true, speed, "Profile velocity"},
      {object::profile_acceleration, 0, 32, false, rw, true, acceleration, "Profile acceleration"},
      {object::profile_deceleration, 0, 32, false, rw, true, acceleration, "Profile deceleration"},
      {object::quick_stop_deceleration, 0, 32, false, rw, true, acceleration, "Quick stop deceleration"},
      {object::homing_method, 0, 8, true, rw, false, 0, "Homing method"},
      {object::position_unit, 0, 32, false, constant, false, micrometres, "SI unit position"},
      {object::speed_unit, 0, 32, false, constant, false, micrometres | per_second, "SI unit velocity"},
      {object::acceleration_unit, 0, 32, false, constant, false, micrometres | per_second_squared,
       "SI unit acceleration"},
      {object::interpolation, 0, 8, false, constant, false, 2, "Highest sub-index supported"},
      {object::interpolation, 1, 8, false, rw, false, 10, "Interpolation time period value"},
      {object::interpolation, 2, 8, true, rw, false, raw(-3) & 0xFF, "Interpolation time index"},
      {object::most_acceleration, 0, 32, false, constant, false, acceleration, "Max acceleration"},
      {object::following_error, 0, 32, true, ro, true, 0, "Following error actual value"},
      {object::supported_modes, 0, 32, false, constant, false, modes, "Supported drive modes"},
  };
}

template <class T> bool is_one_of(T value, std::initializer_list<T> allowed) {
  return std::find(allowed.begin(), allowed.end(), value) != allowed.end();
}

/// The axis accelerates as smoothly as its config says: slower cannot be had.
SdoAbort accept_acceleration(const ObjectDictionary& dictionary, std::uint32_t value) {
  return value < dictionary.number(object::most_acceleration, 0) ? SdoAbort::too_low : SdoAbort::none;
}

SdoAbort accept_interpolation(std::uint8_t sub, std::uint32_t value) {
  if (sub == 1) return value == 0 ? SdoAbort::too_low : SdoAbort::none;
  return is_one_of(static_cast<std::int8_t>(value), {std::int8_t{-4}, std::int8_t{-3}, std::int8_t{-2}})
             ? SdoAbort::none
             : SdoAbort::value;
}

/// Classes of CiA 402-2; 0xFF00 and above are the manufacturer's: what a pneumatic axis has beyond them.
struct ErrorRow {
  std::uint16_t code;
  std::uint64_t faults;
};
constexpr std::array error_rows{
    ErrorRow{0x9000, fault_emergency_stop},  // external error
    ErrorRow{0x8612, fault_limit_switch | fault_end_stop | fault_position_range},  // reference limit
    ErrorRow{0x7305, fault_position_missing | fault_position_jump | fault_position_frozen | fault_position_unreliable |
                         fault_position_unknown},
    ErrorRow{0x8400, fault_speed},
    ErrorRow{0x8611, fault_deviation | fault_start_motion},  // following error
    ErrorRow{0x7121, fault_stall},  // motor blocked
    ErrorRow{0x5100, fault_valve_power},  // supply
    ErrorRow{0x5000, fault_output_missed | fault_output_unconfirmed | fault_node_emergency},  // device hardware
    ErrorRow{0x7500, fault_bus_off | fault_link_down | fault_node_lost | fault_double_answer},  // communication
    ErrorRow{0x6010, fault_guard_lost},  // watchdog
    ErrorRow{0x6100, fault_late_tick | fault_missed_slots | fault_suspended | fault_checks_rested |
                         fault_command_not_finite | fault_estimate_invalid},  // internal software
    ErrorRow{0xFF02, fault_supply_missing | fault_supply_frozen | fault_supply_low},
    ErrorRow{0xFF03, fault_pressure_limit},
    ErrorRow{0xFF04,
             fault_flow_mismatch_1 | fault_flow_mismatch_2 | fault_chamber_mismatch_1 | fault_chamber_mismatch_2},
    ErrorRow{0xFF05, ~std::uint64_t{0}},  // the pressure sensors
};

}  // namespace

std::uint16_t drive_error_code(std::uint64_t faults) noexcept {
  for (const ErrorRow& row : error_rows)
    if ((faults & row.faults) != 0) return row.code;
  return 0;
}

std::string drive_eds(const Rig& rig) {
  CanopenNode node({static_cast<std::uint8_t>(rig.serve->drive->node_id), drive_device_type, rig.name});
  add_drive_objects(rig, node);
  return eds_text(node);
}

void add_drive_objects(const Rig& rig, CanopenNode& node) {
  ObjectDictionary& dictionary = node.dictionary();
  for (const ObjectRow& row : rows_of(rig))
    dictionary.add(row.index, row.sub,
                   {.bits = row.bits,
                    .value = row.value,
                    .can_write = row.access == Access::write,
                    .can_map = row.can_map,
                    .name = row.name,
                    .is_signed = row.is_signed,
                    .is_constant = row.access == Access::constant});
  dictionary.name_object(object::faults, "Faults of the axis");
  dictionary.name_object(object::position_limit, "Software position limit");
  dictionary.name_object(object::interpolation, "Interpolation time period");
  const auto mapped = [&](std::uint16_t index) {
    return CanObject{static_cast<std::uint32_t>(index) << 16 | dictionary.find(index, 0)->bits};
  };
  node.map(false, 1, {mapped(object::controlword), mapped(object::mode)}, 255);
  node.map(false, 2, {mapped(object::target_position), mapped(object::profile_speed)}, 255);
  node.map(true, 1, {mapped(object::statusword), mapped(object::mode_display), mapped(object::error_code)}, 255);
  dictionary.set_number(0x1800, 5, status_event_timer_ms);
  node.map(true, 2, {mapped(object::position_actual), mapped(object::speed_actual)}, 255);
}

SdoAbort accept_drive_object(const ObjectDictionary& dictionary, std::uint16_t index, std::uint8_t sub,
                             std::uint32_t value) {
  const auto word = static_cast<std::int16_t>(value);
  const auto byte = static_cast<std::int8_t>(value);
  const auto only = [](bool is_allowed) { return is_allowed ? SdoAbort::none : SdoAbort::value; };
  switch (index) {
    case object::abort_option: return only(word >= -1 && word <= 3);
    case object::quick_stop_option: return only((word >= 0 && word <= 2) || word == 5 || word == 6);
    case object::shutdown_option:
    case object::disable_option: return only(word == 0 || word == 1);
    case object::mode: return only(byte == 0 || byte == 1 || byte == 6 || byte == 8);
    case object::homing_method: return only(byte == 0 || byte == 35 || byte == 37);
    case object::profile_speed: return value == 0 ? SdoAbort::too_low : SdoAbort::none;
    case object::profile_acceleration:
    case object::profile_deceleration:
    case object::quick_stop_deceleration: return accept_acceleration(dictionary, value);
    case object::interpolation: return accept_interpolation(sub, value);
    default: return SdoAbort::none;
  }
}

}  // namespace pneuservo
