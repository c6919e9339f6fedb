// Disturbances of one frequency, which no name holds: a force that shakes the slider, a supply that swings.
#pragma once
#include "diagnosis/verdict/decision.hpp"

namespace pneuservo {

/// Whether one sine takes this share of what is left of the force in motion; it then is the line of the decision's
/// levels and in its reason.
bool find_periodic_force(const ResidualModel& model, const DecisionRules& rules, double least_share,
                         Decision& decision);
/// Whether one sine takes more of what the owner's model leaves of F than the names do: names that are fitted to a
/// shaken motion follow the shaking. The verdict then is `unknown` at the motion.
bool find_shaking(ResidualModel& model, const Search& search, const DecisionRules& rules, Decision& decision);
/// Whether a supply that swings takes more of the owner's squared mismatch than the names do, at its one frequency; the
/// verdict then is `unknown` there. The pressures that it moves move the piston too, so no sine of F speaks against it.
bool find_supply_swing(ResidualModel& model, const Search& search, const DecisionRules& rules, double taken_by_names,
                       Decision& decision);

}  // namespace pneuservo
