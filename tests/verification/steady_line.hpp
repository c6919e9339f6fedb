// A line run to steady flow: shared by V08 (both ends given) and V17 (orifice and line in series).
#pragma once
#include "gas_rig.hpp"

namespace verification {

struct SteadyFlow {
  double mass_flow, end_velocity, end_temperature, end_pressure, port_pressure;
  double mach() const { return std::fabs(end_velocity) / std::sqrt(1.4 * 287.0 * end_temperature); }
};

inline int steady_cells(Resolution resolution, int fine) { return resolution == Resolution::normal ? 10 : fine; }

/// Steps `advance` until the flows at both ends agree to 1e-8 and have not changed by more over 20 ms.
template <class Step> SteadyFlow run_to_steady(Line<double>& line, const Step& advance) {
  double before = 0.0, fastest = 100.0;
  LineFlow<double> flow;
  for (int block = 0; block < 1500; ++block) {
    const int n = substeps_of(line, 0.02, fastest);
    line.set_time_step(0.02 / n);
    for (int i = 0; i < n; ++i) flow = advance();
    fastest = std::max(20.0, 1.1 * line.largest_speed());
    const double G = flow.chamber_mass_flow_kgps;
    const bool steady = std::fabs(G - before) < 1e-8 * std::fabs(G) && std::fabs(flow.port_mass_flow_kgps - G) < 1e-8 * std::fabs(G);
    before = G;
    if (steady && block > 20) break;
  }
  const int last = line.cells() - 1;
  const double G = flow.chamber_mass_flow_kgps, u = line.face_velocity(line.cells()), T = line.cell_temperature(last);
  return {G, u, T, G * 287.0 * T / (u * line.cross_section()), line.port_pressure()};
}

}  // namespace verification
