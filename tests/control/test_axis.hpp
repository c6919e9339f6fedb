// The nominal cylinder axis with lines of 10 m x 7.65 mm, and gains, for the controller's tests.
#pragma once
#include <pneuservo/control/parameters.hpp>
#include <pneuservo/rig/axis.hpp>

namespace pneuservo::test {

inline AxisParameters<double> nominal_axis(double length_m = 10.0, double diameter_m = 0.00765) {
  AxisParameters<double> axis;
  axis.supply.pressure_Pa = 700e3;
  axis.valve.command_max_V = 5.0;
  axis.valve.area_per_volt_m2_per_V = 2.6e-6;
  axis.valve.area_max_m2 = 1.3e-5;
  axis.valve.critical_pressure_ratio = 0.35;
  axis.line_1.length_m = axis.line_2.length_m = length_m;
  axis.line_1.diameter_m = axis.line_2.diameter_m = diameter_m;
  axis.cylinder = {0.300, 1.257e-3, 1.056e-3, 2e-5, 2e-5, 50.0, 0.3};
  axis.slider.mass_kg = 2.0;
  axis.slider.viscous_friction_Ns_per_m = 60.0;
  return axis;
}

/// The same axis with both sides alike, so that motion and mirrored motion must give opposite commands.
inline AxisParameters<double> symmetric_axis() {
  AxisParameters<double> axis = nominal_axis();
  axis.cylinder.area_2_m2 = axis.cylinder.area_1_m2;
  return axis;
}

inline PdForceParameters nominal_gains() {
  PdForceParameters p;
  p.position_gain_N_per_m = 7550.0;
  p.velocity_gain_Ns_per_m = 95.6;
  p.velocity_filter_s = 0.003;
  p.force_gain_V_per_N = 0.00572;
  return p;
}

}  // namespace pneuservo::test
