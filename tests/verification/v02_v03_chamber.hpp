// A chamber held at x = +0.15 m behind one orifice: shared by the discharge (V02) and the charging case (V03).
#pragma once
#include "gas_rig.hpp"

namespace verification {

inline constexpr double isothermal_wall = 1e14;  // W/(m2 K): the gas is at wall temperature after every step

/// Records pressure, temperature, mass and the heat given to the wall over time.
struct ChamberRun {
  std::vector<double> t, p, T, m, heat;
  double energy_residual = 0.0, enthalpy_in = 0.0;
};

inline double wall_heat_of(const Check& check) {
  const std::string heat = check.text("heat");
  return heat == "adiabatic" ? 0.0 : heat == "isothermal" ? isothermal_wall : 50.0;
}

/// Gas flows between the chamber and an outside at p_outside, 293 K; every `keep` steps of h are kept.
inline ChamberRun run_chamber(double wall_heat, double p_0, double p_outside, double h, int keep, double end_s) {
  const Air<double> air{nominal_air()};
  Chamber<double> chamber;
  const double s = 2.0 * half_stroke, S = 2.6e-6, b = 0.35;
  const auto geometry = chamber_1(wall_heat);
  chamber.configure(geometry, air);
  chamber.reset(p_0, T_start, s);
  ChamberRun run;
  const double area = geometry.wall_area_m2(s), U_0 = chamber.internal_energy();
  double Q = 0.0, implicit_Q = 0.0, H = 0.0;
  const auto store = [&](double t) {
    run.t.push_back(t), run.p.push_back(chamber.pressure()), run.T.push_back(chamber.temperature()),
        run.m.push_back(chamber.mass());
    run.heat.push_back(wall_heat == isothermal_wall ? H - (chamber.internal_energy() - U_0) : Q);
  };
  store(0.0);
  const long n = std::lround(end_s / h);
  for (long i = 1; i <= n; ++i) {
    const double G =
        orifice_mass_flow(air, S, b, p_outside, air.temperature_K, chamber.pressure(), chamber.temperature());
    const double enthalpy = orifice_enthalpy_flow(air, G, air.temperature_K, chamber.temperature());
    const double T_before = chamber.temperature();
    chamber.step(h, {G, enthalpy}, s);
    H += h * enthalpy;
    Q += h * wall_heat * area * (0.5 * (T_before + chamber.temperature()) - air.temperature_K);
    implicit_Q += h * wall_heat * area * (chamber.temperature() - air.temperature_K);  // what the scheme itself takes
    if (i % keep == 0) store(static_cast<double>(i) * h);
  }
  run.enthalpy_in = H;
  run.energy_residual = H - implicit_Q - (chamber.internal_energy() - U_0);
  return run;
}

/// 0.1 ms inside the 1 ms period, or refined: the flow is taken at the start of a step, so the error is that of h.
inline ChamberRun run_chamber(Resolution resolution, double wall_heat, double p_0, double p_outside, double end_s) {
  if (resolution == Resolution::normal) return run_chamber(wall_heat, p_0, p_outside, 1e-4, 1, end_s);
  return run_chamber(wall_heat, p_0, p_outside, 4e-7, 250, end_s);
}

}  // namespace verification
