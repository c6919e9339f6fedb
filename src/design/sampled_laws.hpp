// The controllers' feedback as sampled linear systems: position, velocity, acceleration and reference to the command.
// A law is designed where its parameters have the overloads of sampled_law and the functions below it.
#pragma once
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

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

/// What the force of the air moves.
struct MovedMass {
  double mass_kg = 0.0, friction_Ns_per_m = 0.0;
};
/// A gain by its key.
struct NamedGain {
  std::string_view name;
  double value = 0.0;
  std::string_view unit;
};

StateSpace sampled_law(const PdForceParameters& parameters, const MovedMass& moved, double period_s);
StateSpace sampled_law(const Ppd2Parameters& parameters, const MovedMass& moved, double period_s);
/// The law's gains as those of a PPD2 law with ideal derivatives, and back.
Ppd2Gains linear_gains(const PdForceParameters& parameters, const MovedMass& moved);
Ppd2Gains linear_gains(const Ppd2Parameters& parameters, const MovedMass& moved);
void set_linear_gains(PdForceParameters& parameters, const Ppd2Gains& gains, const MovedMass& moved);
void set_linear_gains(Ppd2Parameters& parameters, const Ppd2Gains& gains, const MovedMass& moved);
/// A gain below 0, which the law does not take; `parameters` have been set to the gains.
std::optional<NamedGain> unusable_gain(const PdForceParameters& parameters, const Ppd2Gains& gains,
                                       const MovedMass& moved);
std::optional<NamedGain> unusable_gain(const Ppd2Parameters& parameters, const Ppd2Gains& gains,
                                       const MovedMass& moved);
void drop_integral(PdForceParameters& parameters);
void drop_integral(Ppd2Parameters& parameters);
/// Gains that the linear ones do not have by name.
std::vector<NamedGain> own_gains(const PdForceParameters& parameters);
std::vector<NamedGain> own_gains(const Ppd2Parameters& parameters);

template <class P>
concept HasLinearLaw = requires(const P& parameters, const MovedMass& moved) { sampled_law(parameters, moved, 1.0); };
inline bool has_linear_law(const ControllerParameters& controller) {
  return controller.in_use([]<class P>(const P&) { return HasLinearLaw<P>; });
}
/// function(parameters) with those of the law in use; throws std::invalid_argument where it has no linear model.
template <class Controller, class F> auto with_linear_law(Controller& controller, F&& function) {
  using Result = decltype(function(controller.template of<PdForce>()));
  return controller.in_use([&]<class P>(P& parameters) -> Result {
    if constexpr (HasLinearLaw<P>) return function(parameters);
    else
      throw std::invalid_argument("controller.kind " + std::string(controller.name()) +
                                  " has no linear model to design with; expected pd_force or ppd2");
  });
}

}  // namespace pneuservo
