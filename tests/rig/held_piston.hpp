// Chambers of a held piston, the valve closed: what leaks, and what feeds a leak, shows in their pressures alone.
#pragma once
#include <vector>

#include <pneuservo/rig/plant.hpp>

#include "rig/nominal_axis.hpp"

namespace pneuservo::test {

/// Pressures of chamber 1 and 2 [Pa], by turns, after each of so many periods of 1 ms.
inline std::vector<double> held_pressures(const AxisEffects<double>& effects, double start_1_Pa, double start_2_Pa,
                                          int periods) {
  AxisParameters<double> axis = nominal_axis();
  axis.effects = effects;
  AxisPlant<double> plant;
  plant.configure(axis, 1e-3, 2.0);
  plant.hold_piston(true);
  plant.reset({0.0, start_1_Pa, start_2_Pa});
  std::vector<double> out;
  for (int k = 0; k < periods; ++k) {
    plant.step(0.0);
    out.push_back(low(plant.chamber_pressure()));
    out.push_back(high(plant.chamber_pressure()));
  }
  return out;
}

}  // namespace pneuservo::test
