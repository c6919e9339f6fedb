// Single recorded channels against what they can hold: ranges, units, zeros, frozen and impossible samples.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/loop/input_guard.hpp>
#include <pneuservo/rig/rig.hpp>

#include "record/column_values.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// One reading of a channel's values: SI = factor recorded + offset.
struct UnitReading {
  double factor = 1, offset = 0;
  std::string name;  ///< "millimetres"; empty: as recorded
  bool needs_fit = false;  ///< a range alone does not ask for it: a simulation must fit then
};

/// Shares of the values that a channel's range is judged by: spikes are judged after it.
inline constexpr double lowest_share = 0.005, highest_share = 0.995;
/// Equal rows that may be a standstill; as many as the loop takes for one.
inline constexpr std::size_t least_standstill = InputGuard::stopped_ticks;

/// The section of the config that a pressure column's sensor has.
template <class Sensors> auto& pressure_sensor(Sensors& sensors, std::string_view column) {
  if (column == "p_supply_Pa") return sensors.supply_pressure;
  return column.find("port") != std::string_view::npos ? sensors.port_pressure : sensors.chamber_pressure;
}

/// Reads a column so from here on, in its source too.
void apply_reading(const UnitReading& reading, Recording& recording, const std::string& column);
/// import: {columns: {x_m: {column: "x", factor: 0.001}}}: what states in the config how columns are read now.
std::string stated_sources(const Recording& recording, const std::vector<std::string>& columns);
/// The same for a reading that is not applied.
std::string stated_reading(Recording recording, const std::string& column, const UnitReading& reading);

/// Columns of sensors that the config does not have do not count, whatever the recorder wrote into them.
void leave_out_absent_sensors(const Rig& rig, Recording& recording, std::vector<std::string>& notes);
/// Where the zero of a position may be that stays within the stroke: at the middle, or at the retracted end.
std::vector<UnitReading> position_zeros(const Rig& rig, const Recording& recording);
/// Position beyond the stroke: another unit, or counted from an end.
void doubt_position_unit(const Rig& rig, Recording& recording, std::vector<std::string>& notes);
/// How pressures may be meant: those readings in which all lie between vacuum and what the loop refuses.
std::vector<UnitReading> pressure_readings(const Rig& rig, const Recording& recording,
                                           const std::vector<std::string>& columns);
/// "%" or "mA", where the file states it for the command; empty: nothing, or a unit of its own.
std::string stated_command_unit(const Recording& recording);
/// How the command may be meant: within the valve's range, in the unit that the file states.
std::vector<UnitReading> command_readings(const Rig& rig, const Recording& recording);
/// Names of the pressure columns that the recording has.
std::vector<std::string> pressure_columns(const Recording& recording);

/// Samples that the loop's own rule would bridge, those at a clipped end, and runs that its rule calls frozen have no
/// value afterwards.
void take_out_impossible_samples(const Rig& rig, Recording& recording, std::vector<std::string>& notes);
/// A recording in which nothing moves.
void refuse_standstill(const Rig& rig, const Recording& recording);

}  // namespace pneuservo
