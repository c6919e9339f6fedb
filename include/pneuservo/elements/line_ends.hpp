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
  FrequencyDependentLosses<S> frequency_dependent_losses;
  S critical_pressure_ratio = S(0.35);
};

}  // namespace pneuservo
