// End cushioning of a cylinder: damping towards an end stop, within a length of it (docs/physics/switched_rigs.md).
#pragma once
#include <pneuservo/core/field.hpp>
#include <pneuservo/core/scalar.hpp>

namespace pneuservo {

/// End cushioning: a force against the motion towards an end within its length.
template <class S> struct CushionParameters {
  S length_m = S(0);
  S damping_Ns_per_m = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"length_m", "m", 0, 1, "from the end stop", Presence::optional}, p.length_m...);
    v(Field{"damping_Ns_per_m", "N s/m", 0, 1e7, "force over speed towards the end", Presence::optional},
      p.damping_Ns_per_m...);
  }
};

/// Force [N] against the motion, F = d v while v > 0 and the end is nearer than the cushion's length, else 0: distance
/// to the end stop [m], speed v towards it [m/s]. Never more than what stops the mass within a step of h_s: a force
/// that is held over the step would turn the motion round.
template <class S>
S cushion_force(const CushionParameters<S>& cushion, const S& distance_m, const S& towards_mps, const S& mass_kg,
                double h_s) noexcept {
  const auto acts = (towards_mps > S(0)) & (distance_m < cushion.length_m);
  return select(acts, minimum(cushion.damping_Ns_per_m, mass_kg / S(h_s)) * towards_mps, S(0));
}

}  // namespace pneuservo
