// Air as an ideal gas, and the flow through an orifice after ISO 6358-1.
#pragma once

#include <algorithm>
#include <cmath>

namespace proof {

struct Gas {
  double gas_constant = 287.0;        // J/(kg K)
  double heat_ratio = 1.4;            // c_p / c_v
  double viscosity_Pas = 1.8e-5;
  double prandtl = 0.71;
  double atmosphere_Pa = 101325.0;

  double cv() const { return gas_constant / (heat_ratio - 1.0); }
  double cp() const { return heat_ratio * cv(); }
  double sound_mps(double temperature_K) const { return std::sqrt(heat_ratio * gas_constant * temperature_K); }
  /// Conductivity of air between 250 and 350 K, W/(m K).
  static double conductivity(double temperature_K) { return 7.95e-5 * temperature_K + 2.0465e-3; }
};

/// Mass flow in kg/s from 1 to 2, below zero the other way; `area_m2` is what an ideal nozzle would have in choked
/// flow, `b` the critical pressure ratio. Above a ratio of 0.999 the flow is linear in the pressure difference
/// (laminar).
inline double orifice_kg_per_s(const Gas& gas, double area_m2, double b, double p1, double t1, double p2, double t2) {
  if (area_m2 <= 0.0 || p1 == p2) return 0.0;
  const double sign = p1 > p2 ? 1.0 : -1.0;
  const double up = std::max(p1, p2), ratio = std::min(p1, p2) / up, temperature = p1 > p2 ? t1 : t2;
  const double k = gas.heat_ratio;
  static thread_local double last_k = 0.0, choked = 0.0;
  if (k != last_k) {
    last_k = k;
    choked = std::sqrt(k * std::pow(2.0 / (k + 1.0), (k + 1.0) / (k - 1.0)));
  }
  const auto subsonic = [b](double r) { return std::sqrt(1.0 - (r - b) * (r - b) / ((1.0 - b) * (1.0 - b))); };
  constexpr double laminar = 0.999;
  double psi = 1.0;
  if (ratio > laminar) psi = (1.0 - ratio) / (1.0 - laminar) * subsonic(laminar);
  else if (ratio > b) psi = subsonic(ratio);
  return sign * choked * area_m2 * up * psi / std::sqrt(gas.gas_constant * temperature);
}

}  // namespace proof
