// Effects of a vessel behind an on/off valve: heat and creep of its wall, heat of its charging, laws of leaks, late
// switching, a pump as its supply.
#pragma once
#include <cmath>

#include <pneuservo/elements/effects.hpp>
#include <pneuservo/elements/orifice.hpp>

namespace pneuservo {

/// Heat between gas and wall beside the configured one.
template <class S> struct WallHeatExchange {
  S conductance_W_per_K = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"conductance_W_per_K", "W/K", 0, 1e6, "heat flow over gas temperature less wall temperature"},
      p.conductance_W_per_K...);
  }
};
/// Gas that charging has warmed above the wall and that cools towards it. Emptying from the supply's pressure without
/// heat from the wall changes its temperature most; filling warms by less.
template <class S> struct ChargingHeat {
  S excess_K = S(0);
  S time_constant_s = S(10);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"excess_K", "K", -150, 150, "gas temperature above the configured one at the start"}, p.excess_K...);
    v(Field{"time_constant_s", "s", 1e-3, 1e5, "of the cooling at constant volume"}, p.time_constant_s...);
  }
};
/// Leak through narrow ways: compressible Poiseuille flow, G = K (p^2 - p_atm^2).
template <class S> struct LaminarLeak {
  S conductance_kgps_per_Pa2 = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"conductance_kgps_per_Pa2", "kg/(s Pa2)", 0, 1, "K of G = K (p^2 - p_atm^2)"},
      p.conductance_kgps_per_Pa2...);
  }
};
/// Leak through a porous wall: a laminar resistance and an orifice in series.
template <class S> struct PorousLeak {
  S conductance_kgps_per_Pa2 = S(0);
  S orifice_area_m2 = S(1e-8);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"conductance_kgps_per_Pa2", "kg/(s Pa2)", 0, 1, "K of G = K (p^2 - p_m^2), p_m between the two"},
      p.conductance_kgps_per_Pa2...);
    v(Field{"orifice_area_m2", "m2", 1e-15, 1e-2, "effective area of the orifice behind it"}, p.orifice_area_m2...);
  }
};
/// A solenoid valve that drops out later than it pulls in.
template <class S> struct DropOutDelay {
  S delay_s = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"delay_s", "s", 0, 5, "dead time of switching to exhaust, beside command_delay"}, p.delay_s...);
  }
};

/// A supply that is a pump: its pressure falls with the flow it gives, from that of the stalled pump on.
template <class S> struct PumpCurve {
  S resistance_Pa_s_per_kg = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"resistance_Pa_s_per_kg", "Pa s/kg", 0, 1e14, "R of p_s - R G, with the flow G that the pump gives"},
      p.resistance_Pa_s_per_kg...);
  }
};
/// A wall of plastic or rubber that goes on giving way after its pressure has changed: beside what it gives at once
/// (part of the volume) V grows by the share g, dg/dt = (c (p - p_atm) - g)/tau.
template <class S> struct WallCreep {
  S growth_per_Pa = S(0);
  S time_constant_s = S(30);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"growth_per_Pa", "1/Pa", 0, 1e-5, "share of the volume by which it has grown at last, per gauge pressure"},
      p.growth_per_Pa...);
    v(Field{"time_constant_s", "s", 1e-2, 1e6, "of the growth"}, p.time_constant_s...);
  }
  /// Share g of the volume, h [s] later at this gauge pressure [Pa].
  S grown(const S& share, double h, const S& gauge_Pa) const noexcept {
    return share - (growth_per_Pa * gauge_Pa - share) * S(std::expm1(-h / time_constant_s));
  }
};

/// All effects of a vessel.
template <class S> struct VesselEffects {
  CommandDelay<S> command_delay;
  DropOutDelay<S> drop_out_delay;
  WallHeatExchange<S> wall_heat_exchange;
  ChargingHeat<S> charging_heat;
  ChamberLeak<S> chamber_leak_1;
  LaminarLeak<S> laminar_leak_1;
  PorousLeak<S> porous_leak_1;
  PumpCurve<S> pump_curve;
  WallCreep<S> wall_creep;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"command_delay", "", 0, 0, "dead time of the command", optional}, p.command_delay...);
    v(Field{"drop_out_delay", "", 0, 0, "further dead time of switching to exhaust", optional}, p.drop_out_delay...);
    v(Field{"wall_heat_exchange", "", 0, 0, "heat between gas and wall", optional}, p.wall_heat_exchange...);
    v(Field{"charging_heat", "", 0, 0, "gas that charging has warmed", optional}, p.charging_heat...);
    v(Field{"chamber_leak_1", "", 0, 0, "leak to atmosphere, an orifice", optional}, p.chamber_leak_1...);
    v(Field{"laminar_leak_1", "", 0, 0, "leak to atmosphere through narrow ways", optional}, p.laminar_leak_1...);
    v(Field{"porous_leak_1", "", 0, 0, "leak to atmosphere through a porous wall", optional}, p.porous_leak_1...);
    v(Field{"pump_curve", "", 0, 0, "supply pressure that falls with the flow of a pump", optional}, p.pump_curve...);
    v(Field{"wall_creep", "", 0, 0, "wall that gives way slowly", optional}, p.wall_creep...);
  }
};

/// Pressure [Pa] behind a pump that gives through an orifice of this area to pressure p [Pa] and temperature T [K].
inline double pressure_behind_pump(const PumpCurve<double>& pump, const Air<double>& air, double area, double b,
                                   double stalled_Pa, double p, double T) noexcept {
  if (pump.resistance_Pa_s_per_kg == 0.0 || area == 0.0 || !(stalled_Pa > p)) return stalled_Pa;
  // Where pump and orifice agree: the pump's flow falls with the pressure, the orifice's grows.
  double low = p, high = stalled_Pa;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    const double flow = orifice_mass_flow(air, area, b, middle, air.temperature_K, p, T);
    (stalled_Pa - pump.resistance_Pa_s_per_kg * flow > middle ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Flow [kg/s] of the three leaks of a vessel from pressure p [Pa] and temperature T [K] to the atmosphere.
inline double vessel_leak_flow(const VesselEffects<double>& effects, const Air<double>& air, double b, double p,
                               double T) noexcept {
  const double atmosphere = air.atmosphere_Pa;
  const auto orifice = [&](double area, double from) {
    return orifice_mass_flow(air, area, b, from, T, atmosphere, air.temperature_K);
  };
  double flow = orifice(effects.chamber_leak_1.area_m2, p) +
                effects.laminar_leak_1.conductance_kgps_per_Pa2 * (p * p - atmosphere * atmosphere);
  const PorousLeak<double>& porous = effects.porous_leak_1;
  if (porous.conductance_kgps_per_Pa2 > 0.0 && p > atmosphere) {
    // The pressure between both, where the flows agree: their difference falls steadily with it.
    double low = atmosphere, high = p;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      const bool is_below =
          porous.conductance_kgps_per_Pa2 * (p * p - middle * middle) > orifice(porous.orifice_area_m2, middle);
      (is_below ? low : high) = middle;
    }
    flow += orifice(porous.orifice_area_m2, 0.5 * (low + high));
  }
  return flow;
}

}  // namespace pneuservo
