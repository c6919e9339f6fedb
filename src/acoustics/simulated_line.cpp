// The simulated line in the place of a test rig: what sensors at its ends would see under a pressure at the port.
#include "acoustics/simulated_line.hpp"

#include <pneuservo/elements/line_with_chamber.hpp>

namespace pneuservo {
namespace {

/// Of the volume's wall: so much that its gas keeps the wall's temperature.
constexpr double isothermal_W_per_m2K = 1e9;

}  // namespace

LinePressures simulated_pressures(const SimulatedLine& line, double period_s, std::size_t rows,
                                  const std::function<double(double t_s)>& port_Pa) {
  const AirParameters<double> air;
  LineParameters<double> parameters;
  parameters.length_m = line.length_m;
  parameters.diameter_m = line.diameter_m;
  LineWithChamber<double> side;
  side.configure(parameters, {1e-3, line.volume_m3, isothermal_W_per_m2K}, air, line.cells);
  LineEffects<double> effects;
  effects.frequency_dependent_losses.share = 1.0;
  side.line().set_effects(effects);
  side.reset(port_Pa(0.0), air.temperature_K, 0.0);
  LinePressures out;
  out.period_s = period_s;
  for (std::size_t k = 0; k < rows; ++k) {
    const double t_s = period_s * static_cast<double>(k);
    out.in_Pa.push_back(port_Pa(t_s));
    out.out_Pa.push_back(side.chamber().pressure());
    const int steps = side.begin_period(period_s);
    for (int i = 0; i < steps; ++i) side.step_prescribed(port_Pa(t_s + period_s * (i + 0.5) / steps), 0.0);
  }
  return out;
}

}  // namespace pneuservo
