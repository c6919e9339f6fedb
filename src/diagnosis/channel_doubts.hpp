// Single recorded channels against what they can hold: ranges, units, zeros, frozen and impossible samples.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// One reading of a channel's values: SI = factor recorded + offset.
struct UnitReading {
  double factor = 1, offset = 0;
  std::string name;  ///< "millimetres"; empty: as recorded
};

/// The value below which this share of the finite values lies; NaN where there is none.
double quantile(std::vector<double> values, double share);

/// "import.columns.x_m: {column: x_m, factor: 0.001}": what states a reading in the config.
std::string stated_reading(const std::string& column, const UnitReading& reading);
void apply_reading(const UnitReading& reading, std::vector<double>& values);

/// Columns of sensors that the config does not have do not count, whatever the recorder wrote into them.
void leave_out_absent_sensors(const Rig& rig, Recording& recording, std::vector<std::string>& notes);
/// Position beyond the stroke: another unit, or counted from an end.
void doubt_position_unit(const Rig& rig, Recording& recording, std::vector<std::string>& notes);
/// How pressures may be meant: those readings in which all lie between vacuum and what the loop refuses.
std::vector<UnitReading> pressure_readings(const Rig& rig, const Recording& recording);
/// How the command may be meant: within the valve's range.
std::vector<UnitReading> command_readings(const Rig& rig, const Recording& recording);
/// Names of the pressure columns that the recording has.
std::vector<std::string> pressure_columns(const Recording& recording);

/// Two columns that are alike to the bit.
void refuse_repeated_channels(const Recording& recording);
/// Samples that the loop's own rule would bridge, and runs that its rule calls frozen, have no value afterwards.
void take_out_impossible_samples(const Rig& rig, Recording& recording, std::vector<std::string>& notes);
/// A recording in which nothing moves.
void refuse_standstill(const Rig& rig, const Recording& recording);

}  // namespace pneuservo
