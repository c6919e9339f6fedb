// What a line of any model exchanges with its ends, and the effects that it may have.
#pragma once
#include <pneuservo/elements/effects.hpp>

namespace pneuservo {

/// What a step of the line hands to its ends. Flow is positive from valve to chamber.
template <class S> struct LineFlow {
  S port_mass_flow_kgps{};
  S chamber_mass_flow_kgps{};
  S chamber_enthalpy_flow_W{};  ///< stagnation enthalpy into the chamber
};

/// The chamber as the line sees it.
template <class S> struct ChamberEnd {
  S pressure_Pa;
  S temperature_K;
};

/// Physics of the line beside the nominal model; neutral by default. Orifices use the valve's critical ratio.
template <class S> struct LineEffects {
  LineRestriction<S> restriction;
  LineLeak<S> leak;
  LineBranch<S> branch;
  PortVolume<S> port_volume;
  FrequencyDependentLosses<S> frequency_dependent_losses;
  S critical_pressure_ratio = S(0.35);

  /// Those of an axis' line 1.
  static LineEffects of_line_1(const AxisEffects<S>& axis) {
    return {axis.line_restriction_1, axis.line_leak_1, axis.line_branch_1, axis.port_volume_1,
            axis.frequency_dependent_losses};
  }
  static LineEffects of_line_2(const AxisEffects<S>& axis) {
    return {axis.line_restriction_2, axis.line_leak_2, axis.line_branch_2, axis.port_volume_2,
            axis.frequency_dependent_losses};
  }
  /// Calls v with each effect of every p; the critical ratio is the valve's.
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(p.restriction...);
    v(p.leak...);
    v(p.branch...);
    v(p.port_volume...);
    v(p.frequency_dependent_losses...);
  }
};

}  // namespace pneuservo
