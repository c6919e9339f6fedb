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
  LineCompliance<S> compliance;
  FlowControl<S> flow_control;
  EndCushion<S> end_cushion;
  FrequencyDependentLosses<S> frequency_dependent_losses;
  S critical_pressure_ratio = S(0.35);

  /// Those of an axis' line 1.
  static LineEffects of_line_1(const AxisEffects<S>& axis) {
    return {axis.line_restriction_1, axis.line_leak_1,    axis.line_branch_1, axis.port_volume_1,
            axis.line_compliance_1,  axis.flow_control_1, axis.end_cushion_1, axis.frequency_dependent_losses};
  }
  static LineEffects of_line_2(const AxisEffects<S>& axis) {
    return {axis.line_restriction_2, axis.line_leak_2,    axis.line_branch_2, axis.port_volume_2,
            axis.line_compliance_2,  axis.flow_control_2, axis.end_cushion_2, axis.frequency_dependent_losses};
  }
  /// Calls v with each effect of every p; the critical ratio is the valve's.
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(p.restriction...);
    v(p.leak...);
    v(p.branch...);
    v(p.port_volume...);
    v(p.compliance...);
    v(p.flow_control...);
    v(p.end_cushion...);
    v(p.frequency_dependent_losses...);
  }
};

/// What stands between a line and its chamber, as one opening for each direction of the flow; 0: none.
template <class S> class EndFittings {
 public:
  void set_effects(const LineEffects<S>& effects) noexcept {
    cushion_ = effects.end_cushion;
    into_chamber_ = effects.restriction.area_m2;
    always_out_ = in_series(into_chamber_, effects.flow_control.area_m2);
    are_cushioned_ = any(cushion_.area_m2 > S(0));
    are_present_ = are_cushioned_ || any(always_out_ > S(0));
    out_of_chamber_ = always_out_;
  }
  bool are_present() const noexcept { return are_present_; }
  bool are_cushioned() const noexcept { return are_cushioned_; }
  /// Of the piston from the chamber's end stop, from here on.
  void set_piston_distance(const S& distance_m) noexcept {
    out_of_chamber_ = in_series(always_out_, select(distance_m < cushion_.length_m, cushion_.area_m2, S(0)));
  }
  S area_m2(const Mask<S>& into_chamber) const noexcept { return select(into_chamber, into_chamber_, out_of_chamber_); }
  /// Behind a fitting the gas at the line's end has the line's pressure: it is throttled before it enters.
  S face_pressure(const Mask<S>& into_chamber, const S& line_Pa, const S& chamber_Pa) const noexcept {
    return are_present_ ? select(area_m2(into_chamber) > S(0), line_Pa, chamber_Pa) : chamber_Pa;
  }

 private:
  // One after the other; their 1/area^2 add up.
  static S in_series(const S& one, const S& other) noexcept {
    const S both = one * other / square_root(maximum(one * one + other * other, S(1e-30)));
    return select(one > S(0), select(other > S(0), both, one), other);
  }
  EndCushion<S> cushion_;
  S into_chamber_{}, always_out_{}, out_of_chamber_{};
  bool are_present_ = false, are_cushioned_ = false;
};

}  // namespace pneuservo
