// The pressure at a valve port where the orifices of the valve meet the first half cell of a line.
#pragma once
#include <pneuservo/elements/orifice.hpp>

namespace pneuservo {

/// Orifices at one port: from supply and to exhaust; areas [m2] >= 0, both may be open (neutral leak).
template <class S> struct ValvePort {
  S supply_area_m2{};
  S exhaust_area_m2{};
  S supply_pressure_Pa{};
  S critical_pressure_ratio{};
};

template <class S> struct PortSolution {
  S pressure_Pa;
  S velocity_mps;
  S mass_flow_kgps;  ///< of the orifices, into the line
};

/// Relative change of the port pressure at which the iteration ends: 1e-7 of 700 kPa is 0.07 Pa, and the step before it
/// was quadratic, so the flow booked is good to rounding of what matters.
inline constexpr double port_tolerance = 1e-7;

namespace detail {
template <class S> struct FlowAndSlope {
  S flow, slope;
};

// Flow from supply side 1 into the port at pressure p and its derivative with p; reversed where p is above p_1.
template <class S>
FlowAndSlope<S> port_orifice(const Air<S>& air, const S& area, const S& b, const S& p_1, const S& T_1, const S& p, const S& T) noexcept {
  const auto inward = p_1 >= p;
  const S p_up = select(inward, p_1, p), p_down = select(inward, p, p_1);
  const S full = area * air.flow_constant / square_root(air.R * select(inward, T_1, T));
  const S r = p_down / p_up;
  const S inverse = S(1) / (S(1) - b);
  const S z = maximum((r - b) * inverse, S(0));
  const S root = square_root(maximum(S(1) - z * z, S(1e-12)));
  const S joint = (S(1 - orifice_linear_width) - b) * inverse;
  const S line_slope = square_root(S(1) - joint * joint) * S(1 / orifice_linear_width);
  const auto straight = r > S(1 - orifice_linear_width);
  const S psi = select(straight, line_slope * (S(1) - r), root);
  const S dpsi = select(straight, -line_slope, -z * inverse / root);  // d psi / d r
  const S flow = full * p_up * psi;
  // Inward: r = p/p_1. Outward: p_up = p, r = p_1/p, d(p psi)/dp = psi - r dpsi.
  return {select(inward, flow, -flow), select(inward, full * dpsi, -full * (psi - r * dpsi))};
}
}  // namespace detail

/// Solves A rho_b (u_star + K p) = G_supply(p) - G_exhaust(p) for the port pressure p, rho_b = p/(R T_s) inward and
/// rho_1 outward: both sides are monotone in p, so Newton inside a bracket that bisects when a step leaves it.
/// [u_star + K p] = m/s; c limits |u|; T_1, rho_1 belong to the first cell; p_start is the last solution.
/// Books the flow of the orifices themselves; with both closed the flow is exactly 0.
template <class S>
PortSolution<S> solve_valve_port(const Air<S>& air, const ValvePort<S>& valve, const S& cross_section, const S& u_star, const S& K,
                                 const S& c, const S& rho_1, const S& T_1, const S& p_start) noexcept {
  const S T_s = air.temperature_K;
  const S inverse_RT = S(1) / (air.R * T_s);
  S low_p = maximum(S(1e3), (-c - u_star) / K), high_p = maximum(low_p, (c - u_star) / K);
  S p = clamp(p_start, low_p, high_p);
  S flow(0);
  for (int iteration = 0; iteration < 40; ++iteration) {
    const S u = u_star + K * p;
    // Stagnation temperature in front of the exhaust: what leaves the line brings its kinetic energy along.
    const S T_out = T_1 + u * u / (S(2) * air.cp);
    const auto supply = detail::port_orifice(air, valve.supply_area_m2, valve.critical_pressure_ratio, valve.supply_pressure_Pa, T_s, p, T_out);
    const auto exhaust = detail::port_orifice(air, valve.exhaust_area_m2, valve.critical_pressure_ratio, air.atmosphere_Pa, T_s, p, T_out);
    flow = supply.flow + exhaust.flow;
    const auto inward = u > S(0);
    const S rho_b = select(inward, p * inverse_RT, rho_1);
    const S residual = cross_section * rho_b * u - flow;
    const S slope = cross_section * (rho_b * K + select(inward, inverse_RT * u, S(0))) - supply.slope - exhaust.slope;
    low_p = select(residual < S(0), p, low_p);
    high_p = select(residual > S(0), p, high_p);
    const S newton = p - residual / slope;
    const S next = select((newton >= low_p) & (newton <= high_p), newton, S(0.5) * (low_p + high_p));
    const S change = absolute(next - p);
    p = next;
    if (all(change <= S(port_tolerance) * p)) break;
  }
  const auto closed = (valve.supply_area_m2 <= S(0)) & (valve.exhaust_area_m2 <= S(0));
  p = select(closed, maximum(-u_star / K, S(1e3)), p);
  return {p, select(closed, S(0), u_star + K * p), select(closed, S(0), flow)};
}

}  // namespace pneuservo
