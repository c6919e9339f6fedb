// The controllers' feedback as sampled linear systems: position, velocity, acceleration and reference to the command.
#pragma once
#include <pneuservo/control/parameters.hpp>

#include "design/state_space.hpp"

namespace pneuservo {

/// PPD2 with its observer (docs/physics/ppd2.md); the reference enters at the position gain alone.
StateSpace ppd2_law(const Ppd2Parameters& parameters, double period_s);

/// PD with force feedback on m x'' + B x' (chamber pressures); the reference enters as a position alone.
StateSpace pd_force_law(const PdForceParameters& parameters, double mass_kg, double friction_Ns_per_m, double period_s);

/// What the position and force gains are as gains of a PPD2 law with ideal derivatives, and back: K_p = k_f k_p,
/// K_v = k_f (k_v + B), K_a = k_f m.
Ppd2Gains as_ppd2_gains(const PdForceParameters& parameters, double mass_kg, double friction_Ns_per_m);
/// Keeps what gains do not say.
PdForceParameters as_pd_force(PdForceParameters parameters, const Ppd2Gains& gains, double mass_kg,
                              double friction_Ns_per_m);

}  // namespace pneuservo
