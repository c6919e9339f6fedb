// What pressures at the valve ports do to a slider.
#include "loop/air_force.hpp"

#include <algorithm>
#include <cmath>

#include <pneuservo/elements/orifice.hpp>

namespace pneuservo {

double air_force_N(const Rig& rig, const std::array<double, 2>& port_Pa) noexcept {
  const auto& c = rig.axis.cylinder;
  return c.area_1_m2 * port_Pa[0] - c.area_2_m2 * port_Pa[1] - (c.area_1_m2 - c.area_2_m2) * rig.axis.air.atmosphere_Pa;
}

double side_volume_m3(const Rig& rig, std::size_t side, double position_m) noexcept {
  const auto& c = rig.axis.cylinder;
  const auto& line = side == 0 ? rig.axis.line_1 : rig.axis.line_2;
  const double half_m = 0.5 * c.stroke_m, x = std::clamp(position_m, -half_m, half_m);
  const double chamber_m3 =
      side == 0 ? c.dead_volume_1_m3 + c.area_1_m2 * (half_m + x) : c.dead_volume_2_m3 + c.area_2_m2 * (half_m - x);
  return line.volume_m3() + chamber_m3;
}

double air_stiffness_N_per_m(const Rig& rig, const std::array<double, 2>& port_Pa, double position_m) noexcept {
  const auto& c = rig.axis.cylinder;
  return port_Pa[0] * c.area_1_m2 * c.area_1_m2 / side_volume_m3(rig, 0, position_m) +
         port_Pa[1] * c.area_2_m2 * c.area_2_m2 / side_volume_m3(rig, 1, position_m);
}

double speed_per_volt_mps(const Rig& rig, const std::array<double, 2>& port_Pa, int direction) noexcept {
  const Air<double> air(rig.axis.air);
  const auto& valve = rig.axis.valve;
  const double T = air.temperature_K, b = valve.critical_pressure_ratio, supply_Pa = rig.axis.supply.pressure_Pa;
  double fastest = 0.0;
  for (std::size_t side = 0; side < 2; ++side) {
    const double area_m2 = side == 0 ? rig.axis.cylinder.area_1_m2 : rig.axis.cylinder.area_2_m2;
    const double p = std::clamp(port_Pa[side], air.atmosphere_Pa, supply_Pa);
    const bool fills = (side == 0) == (direction > 0);
    const double flux = fills ? orifice_flux(air, supply_Pa, T, p, b) : orifice_flux(air, p, T, air.atmosphere_Pa, b);
    fastest = std::max(fastest, flux * valve.area_per_volt_m2_per_V * air.R * T / (p * area_m2));
  }
  return fastest;
}

}  // namespace pneuservo
