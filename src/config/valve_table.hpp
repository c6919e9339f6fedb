// A valve that was measured: areas or flows over the command, turned into the numbers of a config.
#pragma once
#include <span>
#include <string>

#include <pneuservo/rig/rig.hpp>

#include "config/config_tree.hpp"
#include "config/input_errors.hpp"

namespace pneuservo {

/// One point of a static measurement at one port: the edge from the supply for commands above 0, to the exhaust below.
struct ValvePoint {
  double command_V = 0, area_m2 = 0;
};

/// The curve of `Valve::areas` nearest to the points in least squares, the exhaust edge like that of the supply.
struct ValveTableFit {
  double area_per_volt_m2_per_V = 0, area_max_m2 = 0;
  double offset_V = 0, dead_band_V = 0, near_middle = 0, wide_open = 0;
  double misfit_m2 = 0;  ///< root mean square
};
/// At least eight points, the largest area above 0, commands within +-command_max_V.
ValveTableFit fit_valve_table(std::span<const ValvePoint> points, double command_max_V);

/// Replaces `valve.table` of a config by what it gives: area_per_volt_m2_per_V and area_max_m2, and under `effects`
/// valve_curve, valve_offset and valve_dead_band, each unless it is stated there. What cannot be read goes to errors.
void translate_valve_table(ConfigNode& root, InputErrors& errors);

}  // namespace pneuservo
