// Mass flow through a restriction, ISO 6358 form: valve edges, fittings, leaks (thesis 3.11 to 3.14, 2.7).
#pragma once
#include <pneuservo/elements/air.hpp>

namespace pneuservo {

/// Width of the straight piece at equal pressures: the slope of the ellipse is infinite at r = 1.
inline constexpr double orifice_linear_width = 1e-3;

/// psi(r, b): 1 for r <= b, sqrt(1 - ((r - b)/(1 - b))^2) above, straight from (1, 0) to psi(1 - 1e-3) at the end.
/// r = p_down / p_up in [0, 1], b critical pressure ratio in (0, 1); dimensionless.
template <class S> S orifice_psi(const S& r, const S& b) noexcept {
  const S inverse = S(1) / (S(1) - b);
  const S joint = (S(1 - orifice_linear_width) - b) * inverse;
  const S at_joint = square_root(S(1) - joint * joint);
  const S z = maximum((r - b) * inverse, S(0));
  const S ellipse = square_root(maximum(S(1) - z * z, S(0)));
  const S straight = at_joint * ((S(1) - r) * S(1 / orifice_linear_width));
  return select(r > S(1 - orifice_linear_width), straight, ellipse);
}

/// p_up psi(p_down/p_up) [Pa] by one root and no division, for p_down at most (1 - orifice_linear_width) p_up, where
/// psi is no straight piece. Absolute pressures [Pa]; b as in orifice_psi.
template <class S> S orifice_pressure_psi(const S& p_up, const S& p_down, const S& b) noexcept {
  const S beyond = maximum((p_down - b * p_up) * (S(1) / (S(1) - b)), S(0));
  return square_root(p_up * p_up - beyond * beyond);
}

/// Flow per effective area from upstream pressure p_up [Pa] at stagnation temperature T_up [K] to p_down <= p_up:
/// G/S = K_f p_up / sqrt(R T_up) psi(p_down/p_up) [kg/(s m2)].
template <class S> S orifice_flux(const Air<S>& air, const S& p_up, const S& T_up, const S& p_down,
                                  const S& b) noexcept {
  return air.flow_constant * p_up / square_root(air.R * T_up) * orifice_psi(p_down / p_up, b);
}

/// Mass flow [kg/s] from side 1 to side 2 (negative: the other way), with the upstream side's temperature;
/// area [m2] >= 0, pressures absolute [Pa] > 0. Exactly antisymmetric, exactly 0 at equal pressures.
template <class S>
S orifice_mass_flow(const Air<S>& air, const S& area, const S& b, const S& p_1, const S& T_1, const S& p_2,
                    const S& T_2) noexcept {
  const auto forward = p_1 >= p_2;
  const S p_up = select(forward, p_1, p_2), p_down = select(forward, p_2, p_1);
  const S flow = area * orifice_flux(air, p_up, select(forward, T_1, T_2), p_down, b);
  return select(forward, flow, -flow);
}

/// Enthalpy [W] that crosses with the flow G [kg/s]: c_p T_up G, T_up the upstream stagnation temperature.
template <class S> S orifice_enthalpy_flow(const Air<S>& air, const S& G, const S& T_1, const S& T_2) noexcept {
  return air.cp * G * select(G >= S(0), T_1, T_2);
}

}  // namespace pneuservo
