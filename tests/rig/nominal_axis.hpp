// The nominal cylinder axis (docs/physics) that tests and benchmarks start from.
#pragma once
#include <pneuservo/rig/axis.hpp>

namespace pneuservo::test {

/// Both lines alike; 10 m of 7.65 mm unless said otherwise.
inline AxisParameters<double> nominal_axis(double length_m = 10.0, double diameter_m = 0.00765) {
  AxisParameters<double> axis;
  axis.supply.pressure_Pa = 700e3;
  axis.valve.command_max_V = 5.0;
  axis.valve.area_per_volt_m2_per_V = 2.6e-6;
  axis.valve.area_max_m2 = 1.3e-5;
  axis.valve.critical_pressure_ratio = 0.35;
  axis.line_1.length_m = axis.line_2.length_m = length_m;
  axis.line_1.diameter_m = axis.line_2.diameter_m = diameter_m;
  axis.cylinder.stroke_m = 0.3;
  axis.cylinder.area_1_m2 = 1.257e-3;
  axis.cylinder.area_2_m2 = 1.056e-3;
  axis.cylinder.dead_volume_1_m3 = axis.cylinder.dead_volume_2_m3 = 2e-5;
  axis.cylinder.wall_heat_W_per_m2K = 50.0;
  axis.slider.mass_kg = 2.0;
  axis.slider.viscous_friction_Ns_per_m = 60.0;
  return axis;
}

}  // namespace pneuservo::test
