// A sine of F on the owner's model or on the best name's, and a swing of the supply that the model answers to.
#include "diagnosis/verdict/disturbances.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "diagnosis/residuals/periodic_supply.hpp"

namespace pneuservo {

namespace {

/// That no name is given, for what disturbs the owner's machine at this element.
Decision unknown_at(const std::string& element, ResidualModel& model, const Search& search,
                    const DecisionRules& rules) {
  Decision decision;
  decision.verdict = Verdict::unknown;
  decision.element = element;
  decision.chosen = &search.owner();
  decision.rivals = {decision.chosen};
  decision.probabilities = probabilities_of(decision.rivals, rules, rules.most_sure);
  decision.levels = model_levels(model, decision.chosen->fit, rules);
  decision.reason = what_is_left(decision, model, rules);
  return decision;
}

}  // namespace

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
  Decision shaken = unknown_at("motion", model, search, rules);
  shaken.is_shaken = true;
  double taken = 0;
  for (std::size_t c = 0; c < model.channels().size(); ++c)
    if (model.channels()[c].name == "F")
      taken = 1 - std::pow(decision.levels.channels[c].fitted / std::max(shaken.levels.channels[c].fitted, 1e-300), 2);
  if (!find_periodic_force(model, rules, std::max(rules.taken_share, taken), shaken)) return false;
  decision = std::move(shaken);
  return true;
}

bool find_supply_swing(ResidualModel& model, const Search& search, const DecisionRules& rules, double taken_by_names,
                       Decision& decision) {
  if (taken_by_names >= rules.most_sure || !search.owner_wants_more_swing()) return false;  // spares the sweep
  Hypothesis steady = search.owner().fit.hypothesis();
  steady.swing_Pa.clear();
  FittedRows rows(model, {});
  const auto swing = strongest_supply_swing(rows, steady);
  double stated_Pa = 0;
  for (const ResidualChannel& channel : model.channels()) stated_Pa = std::max(stated_Pa, channel.stated);
  if (!swing || swing->amplitude_Pa <= stated_Pa || swing->share < std::max(rules.taken_share, taken_by_names) ||
      rules.worse_fit * (1 - swing->share) > 1 - swing->next_share)
    return false;
  decision = unknown_at("supply", model, search, rules);
  decision.reason =
      fmt::format("a supply pressure that swings by {:.2g} kPa at {:.2f} Hz takes {:.0f} % of the squared mismatch; {}",
                  1e-3 * swing->amplitude_Pa, swing->frequency_Hz, 100 * swing->share, decision.reason);
  return true;
}

}  // namespace pneuservo
