// The nominal cylinder axis, one with both sides alike, and gains, for the controller's tests.
#pragma once
#include <pneuservo/control/parameters.hpp>

#include "rig/nominal_axis.hpp"

namespace pneuservo::test {

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
