// A sine of F on the owner's model or on the best name's, and a swing of the supply that the model answers to.
#include "diagnosis/disturbances.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "diagnosis/periodic_supply.hpp"

namespace pneuservo {

bool find_periodic_force(const ResidualModel& model, const DecisionRules& rules, double least_share,
                         Decision& decision) {
  for (std::size_t c = 0; c < model.channels().size(); ++c) {
    if (model.channels()[c].name != "F" || decision.levels.channels[c].fitted <= rules.floor_level) continue;
    const std::optional<SpectralLine> line =
        line_in_motion(model.rows(), decision.levels.residual, static_cast<int>(c));
    if (!line || line->ratio < least_share) continue;
    decision.levels.line = line;
    decision.reason += fmt::format("; a periodic force of {:.2g} N at {:.2f} Hz takes {:.0f} % of what is left of F",
                                   line->amplitude, line->frequency_Hz, 100 * line->ratio);
    return true;
  }
  return false;
}

bool find_shaking(ResidualModel& model, const Search& search, const DecisionRules& rules, Decision& decision) {
  Decision shaken = decision;
  shaken.chosen = &search.owner();
  shaken.levels = model_levels(model, shaken.chosen->fit.hypothesis(), rules);
  shaken.reason = what_is_left(shaken, model, rules);
  double taken = 0;
  for (std::size_t c = 0; c < model.channels().size(); ++c)
    if (model.channels()[c].name == "F")
      taken = 1 - std::pow(decision.levels.channels[c].fitted / std::max(shaken.levels.channels[c].fitted, 1e-300), 2);
  if (!find_periodic_force(model, rules, std::max(rules.periodic_share, taken), shaken)) return false;
  shaken.rivals = {shaken.chosen};
  shaken.probabilities = probabilities_of(shaken.rivals, rules);
  shaken.gain = 0;
  shaken.verdict = Verdict::unknown;
  shaken.element = "motion";
  shaken.is_shaken = true;
  decision = std::move(shaken);
  return true;
}

bool find_supply_swing(ResidualModel& model, const Search& search, const DecisionRules& rules, double taken_by_names,
                       Decision& decision) {
  if (taken_by_names >= rules.nearly_all_share) return false;  // spares the sweep
  const auto swing = strongest_supply_swing(model, search.owner().fit.hypothesis());
  if (!swing || swing->share < std::max(rules.swing_share, taken_by_names) ||
      1 - swing->share > rules.swing_left * (1 - swing->next_share))
    return false;
  decision.chosen = &search.owner();
  decision.rivals = {decision.chosen};
  decision.probabilities = probabilities_of(decision.rivals, rules);
  decision.gain = 0;
  decision.verdict = Verdict::unknown;
  decision.element = "supply";
  decision.levels = model_levels(model, decision.chosen->fit.hypothesis(), rules);
  decision.reason = fmt::format(
      "a supply pressure that swings by {:.2g} kPa at {:.2f} Hz takes {:.0f} % of the squared mismatch; {}",
      1e-3 * swing->amplitude_Pa, swing->frequency_Hz, 100 * swing->share, what_is_left(decision, model, rules));
  return true;
}

}  // namespace pneuservo
