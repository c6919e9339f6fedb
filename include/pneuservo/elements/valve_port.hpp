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

/// Relative change of the port pressure at which the iteration ends. A Newton step squares the relative error, so what
/// is left after a step of this size is about 1e-10; the flow booked is the one of the linearised orifices at its end.
inline constexpr double port_tolerance = 1e-5;

namespace detail {
// One orifice between a side 1 at fixed pressure and the port.
template <class S> struct PortOrifice {
  S pressure, inverse_pressure;
  S inward, outward;  // choked flow per upstream pressure, side 1 or port upstream
};
// Flow into the port at pressure p and its derivative with p times `root`: the ellipse's slope has a root below the
// line, and Newton's step needs only the product, which saves the division.
template <class S> struct FlowAndSlope {
  S flow, slope_times_root, root;
};
template <class S> struct OrificeShape {
  S critical, inverse, line_slope;  // b, 1/(1 - b), slope of the straight piece

  explicit OrificeShape(const S& b) noexcept : critical(b), inverse(S(1) / (S(1) - b)) {
    const S joint = (S(1 - orifice_linear_width) - b) * inverse;
    line_slope = square_root(S(1) - joint * joint) * S(1 / orifice_linear_width);
  }
  [[gnu::always_inline]] FlowAndSlope<S> at(const PortOrifice<S>& orifice, const S& p,
                                            const S& inverse_p) const noexcept {
    const auto inward = orifice.pressure >= p;
    const S r = select(inward, p * orifice.inverse_pressure, orifice.pressure * inverse_p);
    const S z = maximum((r - critical) * inverse, S(0));
    const auto straight = r > S(1 - orifice_linear_width);
    const S ellipse = square_root(maximum(S(1) - z * z, S(1e-12)));
    const S root = select(straight, S(1), ellipse);
    const S psi = select(straight, line_slope * (S(1) - r), ellipse);
    const S dpsi = select(straight, -line_slope, -z * inverse);  // d psi / d r times root
    // Inward: r = p/p_1. Outward: p_up = p, r = p_1/p, d(p psi)/dp = psi - r dpsi.
    return {select(inward, orifice.inward * orifice.pressure, -orifice.outward * p) * psi,
            select(inward, orifice.inward * dpsi, -orifice.outward * (psi * root - r * dpsi)), root};
  }
};
}  // namespace detail

/// What the solution needs of the gas and the orifices' shape, computed once.
template <class S> struct PortConstants {
  double tolerance;  ///< relative change of the port pressure at which the iteration ends
  S inverse_RT, half_inverse_cp, inflow,
      inverse_atmosphere;  // inflow: K_f/sqrt(R T_s), choked flow per pressure and area
  detail::OrificeShape<S> shape;

  PortConstants() noexcept : PortConstants(Air<S>{}, S(0.35)) {}
  PortConstants(const Air<S>& air, const S& critical_pressure_ratio, double ends_at = port_tolerance) noexcept
      : tolerance(ends_at), inverse_RT(S(1) / (air.R * air.temperature_K)), half_inverse_cp(S(0.5) / air.cp),
        inflow(air.flow_constant / square_root(air.R * air.temperature_K)),
        inverse_atmosphere(S(1) / air.atmosphere_Pa), shape(critical_pressure_ratio) {}
};

/// Flow of both orifices into a port at pressure p [kg/s], all gas at ambient temperature.
template <class S>
S valve_port_inflow(const PortConstants<S>& k, const Air<S>& air, const ValvePort<S>& valve, const S& p) noexcept {
  const S inverse_p = S(1) / p, open_supply = valve.supply_area_m2 * k.inflow,
          open_exhaust = valve.exhaust_area_m2 * k.inflow;
  const detail::PortOrifice<S> supply{valve.supply_pressure_Pa, S(1) / valve.supply_pressure_Pa, open_supply,
                                      open_supply};
  const detail::PortOrifice<S> exhaust{air.atmosphere_Pa, k.inverse_atmosphere, open_exhaust, open_exhaust};
  return k.shape.at(supply, p, inverse_p).flow + k.shape.at(exhaust, p, inverse_p).flow;
}

/// Solves A rho_b (u_star + K p) = G_supply(p) - G_exhaust(p) for the port pressure p, rho_b = p/(R T_s) inward and
/// rho_1 outward: both sides are monotone in p, so Newton inside a bracket that bisects when a step leaves it.
/// [u_star + K p] = m/s; c limits |u|; T_1, rho_1 belong to the first cell; p_start is near the solution.
/// Books the flow of the orifices themselves; with both closed the flow is exactly 0.
/// One or two steps are nearly always enough; a lane that has converged stays, so that its result does not depend on
/// its neighbours.
template <class S>
PortSolution<S> solve_valve_port(const PortConstants<S>& k, const Air<S>& air, const ValvePort<S>& valve,
                                 const S& cross_section, const S& u_star, const S& K, const S& c, const S& rho_1,
                                 const S& T_1, const S& p_start) noexcept {
  const S inverse_K = S(1) / K;
  S low_p = maximum(S(1e3), (-c - u_star) * inverse_K), high_p = maximum(low_p, (c - u_star) * inverse_K);
  S p = clamp(p_start, low_p, high_p);
  detail::PortOrifice<S> supply{valve.supply_pressure_Pa, S(1) / valve.supply_pressure_Pa,
                                valve.supply_area_m2 * k.inflow, S(0)};
  detail::PortOrifice<S> exhaust{air.atmosphere_Pa, k.inverse_atmosphere, valve.exhaust_area_m2 * k.inflow, S(0)};
  // Stagnation temperature in front of the exhaust: what leaves the line brings its kinetic energy along.
  const auto set_outflow = [&](const S& u) noexcept {
    const S out = air.flow_constant / square_root(air.R * (T_1 + u * u * k.half_inverse_cp));
    supply.outward = valve.supply_area_m2 * out;
    exhaust.outward = valve.exhaust_area_m2 * out;
  };
  set_outflow(u_star + K * p);
  S flow(0);
  auto done = flow > S(0);
  for (int iteration = 0; iteration < 40; ++iteration) {
    const S u = u_star + K * p, inverse_p = S(1) / p;
    const auto from_supply = k.shape.at(supply, p, inverse_p), from_exhaust = k.shape.at(exhaust, p, inverse_p);
    const S orifices = from_supply.flow + from_exhaust.flow;
    const auto inward = u > S(0);
    const S rho_b = select(inward, p * k.inverse_RT, rho_1);
    const S line = cross_section * (rho_b * u);
    const S line_slope = cross_section * (rho_b * K + select(inward, k.inverse_RT * u, S(0)));
    const S residual = line - orifices;
    low_p = select(residual < S(0), p, low_p);
    high_p = select(residual > S(0), p, high_p);
    const S roots = from_supply.root * from_exhaust.root;
    const S slope = line_slope * roots - from_supply.slope_times_root * from_exhaust.root -
                    from_exhaust.slope_times_root * from_supply.root;
    const S newton = p - residual * roots / slope;
    const auto inside = (newton >= low_p) & (newton <= high_p);
    const S next = select(inside, newton, S(0.5) * (low_p + high_p));
    const S change = next - p;
    flow = select(done, flow, select(inside, line + line_slope * change, orifices));
    p = select(done, p, next);
    done = done | (absolute(change) <= S(k.tolerance) * p);
    if (all(done)) [[likely]]
      break;
    // Where two steps are enough the start is near, and so is its stagnation temperature (1e-4 of the flow).
    if (iteration > 0) set_outflow(u_star + K * p);
  }
  const auto closed = (valve.supply_area_m2 <= S(0)) & (valve.exhaust_area_m2 <= S(0));
  p = select(closed, maximum(-u_star * inverse_K, S(1e3)), p);
  return {p, select(closed, S(0), u_star + K * p), select(closed, S(0), flow)};
}

/// The same with the constants computed on the spot.
template <class S>
PortSolution<S> solve_valve_port(const Air<S>& air, const ValvePort<S>& valve, const S& cross_section, const S& u_star,
                                 const S& K, const S& c, const S& rho_1, const S& T_1, const S& p_start) noexcept {
  return solve_valve_port(PortConstants<S>(air, valve.critical_pressure_ratio), air, valve, cross_section, u_star, K, c,
                          rho_1, T_1, p_start);
}

}  // namespace pneuservo
