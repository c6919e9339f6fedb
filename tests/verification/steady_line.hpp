// A line run to steady flow: shared by V08 (both ends given) and V17 (orifice and line in series).
#pragma once
#include "gas_rig.hpp"

namespace verification {

struct SteadyFlow {
  double mass_flow, end_Mach, end_temperature, end_pressure, port_pressure;
};

/// State of the gas on the face at the chamber, from what leaves the line there: mass flux G/A, stagnation enthalpy
/// h_0 = H/G and the chamber's static pressure p. u = g R T/p in c_p T + u^2/2 = h_0 is a quadratic in T; where its
/// root is above Mach 1 the gas leaves at Mach 1 and the pressure floats above the chamber's.
inline SteadyFlow steady_flow_of(const Line<double>& line, const LineFlow<double>& flow, double chamber_pressure) {
  const Air<double>& air = line.air();
  const double G = flow.chamber_mass_flow_kgps, flux = std::fabs(G) / line.cross_section(),
               h_0 = flow.chamber_enthalpy_flow_W / G;
  const double a = flux * air.R / chamber_pressure;
  const double subsonic = 2.0 * h_0 / (air.cp + std::sqrt(air.cp * air.cp + 2.0 * a * a * h_0));
  const double sonic = h_0 / (air.cp + 0.5 * air.kappa * air.R), T = std::max(subsonic, sonic);
  const double mach = subsonic > sonic ? a * T / std::sqrt(air.kappa * air.R * T) : 1.0;
  return {G, mach, T, flux * air.R * T / (mach * std::sqrt(air.kappa * air.R * T)), line.port_pressure()};
}

/// A number of the steady flow with ten cells, or its limit from 50, 100 and 200.
template <class Number> double steady_number(Resolution resolution, const Number& with_cells) {
  if (resolution == Resolution::normal) return with_cells(10);
  return limit_of(with_cells(50), with_cells(100), with_cells(200));
}

/// Steps `advance` until the flows at both ends agree to 1e-8 and have not changed by more over 20 ms.
template <class Step> SteadyFlow run_to_steady(Line<double>& line, double chamber_pressure, const Step& advance) {
  double before = 0.0, fastest = 100.0;
  LineFlow<double> flow;
  for (int block = 0; block < 1500; ++block) {
    const int n = substeps_of(line, 0.02, fastest);
    line.set_time_step(0.02 / n);
    for (int i = 0; i < n; ++i) flow = advance();
    fastest = std::max(20.0, 1.1 * line.largest_speed());
    const double G = flow.chamber_mass_flow_kgps;
    const bool steady =
        std::fabs(G - before) < 1e-8 * std::fabs(G) && std::fabs(flow.port_mass_flow_kgps - G) < 1e-8 * std::fabs(G);
    before = G;
    if (steady && block > 20) break;
  }
  return steady_flow_of(line, flow, chamber_pressure);
}

}  // namespace verification
