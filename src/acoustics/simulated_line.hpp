// The simulated line in the place of a test rig: what sensors at its ends would see under a pressure at the port.
#pragma once
#include <cstddef>
#include <functional>

#include <pneuservo/elements/parameters.hpp>

#include "acoustics/line_identification.hpp"

namespace pneuservo {

/// A line with frequency-dependent losses before an isothermal volume that does not move.
struct SimulatedLine {
  double length_m = 0.0, diameter_m = 0.0, volume_m3 = 0.0;
  int cells = 0;
};
/// Row k at time k period_s. The port has port_Pa(t) [Pa], also within a period; all begins at rest at port_Pa(0).
LinePressures simulated_pressures(const SimulatedLine& line, double period_s, std::size_t rows,
                                  const std::function<double(double t_s)>& port_Pa);

}  // namespace pneuservo
