// The object dictionary of the axis as a drive: every object of CiA 402 that it has, its units and its defaults.
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <pneuservo/rig/rig.hpp>

#include "can/canopen_node.hpp"

namespace pneuservo {

namespace drive_object {
inline constexpr std::uint16_t faults = 0x2000, stream_delay = 0x2001, abort_option = 0x6007, error_code = 0x603F,
                               controlword = 0x6040, statusword = 0x6041, quick_stop_option = 0x605A,
                               shutdown_option = 0x605B, disable_option = 0x605C, halt_option = 0x605D,
                               fault_option = 0x605E, mode = 0x6060, mode_display = 0x6061, position_demand = 0x6062,
                               position_actual = 0x6064, following_window = 0x6065, following_time = 0x6066,
                               position_window = 0x6067, position_time = 0x6068, speed_demand = 0x606B,
                               speed_actual = 0x606C, target_position = 0x607A, home_offset = 0x607C,
                               position_limit = 0x607D, most_speed = 0x607F, profile_speed = 0x6081,
                               profile_acceleration = 0x6083, profile_deceleration = 0x6084,
                               quick_stop_deceleration = 0x6085, homing_method = 0x6098, position_unit = 0x60A8,
                               speed_unit = 0x60A9, acceleration_unit = 0x60AA, interpolation = 0x60C2,
                               most_acceleration = 0x60C5, following_error = 0x60F4, supported_modes = 0x6502;
}  // namespace drive_object

/// Values of 0x6060.
enum class DriveMode : std::int8_t { none = 0, profile_position = 1, homing = 6, cyclic_position = 8 };
/// Values of 0x6007: what the drive does when its master is gone while the axis is enabled.
enum class DriveAbort : std::int16_t {
  as_configured = -1,
  nothing = 0,
  fault = 1,
  disable_voltage = 2,
  quick_stop = 3
};

/// Units of the bus: micrometres, and seconds.
constexpr double drive_units_per_m = 1e6;
/// To whole units; what a number of 32 bits cannot hold is held at its end.
inline std::int32_t to_drive_units(double si) noexcept {
  using Limits = std::numeric_limits<std::int32_t>;
  const double units = std::round(si * drive_units_per_m);
  if (!(units > static_cast<double>(Limits::min()))) return Limits::min();
  return units >= static_cast<double>(Limits::max()) ? Limits::max() : static_cast<std::int32_t>(units);
}
constexpr double from_drive_units(std::int64_t units) noexcept {
  return static_cast<double>(units) / drive_units_per_m;
}

/// Adds the objects of the application and the mapping that the drive has of its own.
void add_drive_objects(const Rig& rig, CanopenNode& node);
/// Judges what a master writes by SDO.
SdoAbort accept_drive_object(const ObjectDictionary& dictionary, std::uint16_t index, std::uint8_t sub,
                             std::uint32_t value);
/// CiA 402's code (0x603F) for the first fault of the axis, 0 where there is none.
std::uint16_t drive_error_code(std::uint64_t faults) noexcept;
/// The EDS of the axis as a drive. The rig has serve.drive.
std::string drive_eds(const Rig& rig);
/// What 0x1000 says: CiA 402, servo drive.
inline constexpr std::uint32_t drive_device_type = 0x00020192;

}  // namespace pneuservo
