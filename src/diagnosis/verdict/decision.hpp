// From fitted explanations to a verdict: how many effects are real, what is left over, how sure that is.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnosis.hpp"
#include "diagnosis/search/search.hpp"
#include "diagnosis/verdict/decision_rules.hpp"
#include "diagnosis/verdict/left_over.hpp"

namespace pneuservo {

/// Residuals of one model over all rows, and what they say.
struct ModelLevels {
  Eigen::VectorXd residual;
  std::vector<ChannelLevel> channels;
  std::optional<SpectralLine> line;  ///< above `next_gain`

  double chi2(bool held_out) const;
  double highest() const;  ///< of fitted rows, beside what the owner states [sigma]
  double highest_held_out() const;
  /// Chi2 a row on held-out stretches over that on fitted ones; 1 where there are none or they are at their floor: the
  /// floor is wider at the start of a recording, so that fitted rows may stay further below it.
  double held_out_ratio() const;
  double expected_ratio = 1;  ///< of a right model, by the leverage of its fit; 1 where that does not matter
  double held_out_excess() const { return held_out_ratio() / expected_ratio; }
};
ModelLevels model_levels(ResidualModel& model, const Fit& fit, const DecisionRules& rules);

/// The chosen explanation (no members: the owner's model) and its rivals with as many members.
struct Decision {
  Verdict verdict = Verdict::consistent;
  const Explanation* chosen = nullptr;
  std::vector<const Explanation*> rivals;  ///< chosen first, then by evidence
  std::vector<double> probabilities;  ///< of the rivals
  ModelLevels levels;  ///< of the chosen
  double gain = 0;  ///< of the chosen over the owner's model, in log evidence
  std::string reason;  ///< of `unknown`; beside a name: what is left
  std::string element;  ///< where an `unknown` sits, if its names tell; empty: the pattern of what is left has to
  bool is_shaken = false;  ///< `unknown`, but for the frequency of the force that shakes the slider
  bool is_described = false;  ///< `unknown`, but for a shape that its element takes
  bool beside_remainder = false;  ///< the floors have grown with what is left
  double growth = 1;  ///< of squared floors: what evidence and variances are to be divided by
};

/// What of the decision's levels is above the rules' limits, in words; empty: nothing.
std::string what_is_left(const Decision& decision, ResidualModel& model, const DecisionRules& rules);
/// Of rivals, the chosen one first: a first name has to bring `alarm_gain` before it is as likely as nothing at all.
/// They add up to `whole`.
std::vector<double> probabilities_of(const std::vector<const Explanation*>& rivals, const DecisionRules& rules,
                                     double whole);

Decision decide(ResidualModel& model, const Search& search, const DecisionRules& rules);
/// The same on one explanation of the search, whatever is before it.
Decision decide_on(const Explanation& chosen, ResidualModel& model, const Search& search, const DecisionRules& rules);
/// Levels of the chosen explanation as it stands now, and the verdict that they leave.
void judge_what_is_left(ResidualModel& model, const Search& search, const DecisionRules& rules, Decision& decision);
/// The same for a search whose residuals were freed from the slow error that is left everywhere: names what takes most
/// of it, or says unknown. A name needs three things: it brings enough on the floor that the owner's model leaves; on
/// the floor that it leaves itself, the owner's model is refuted; and it takes most of some channel. A force that is
/// periodic while the slider moves has no name. Levels are taken of plain residuals.
Decision decide_beside_remainder(ResidualModel& model, const Search& search, const DecisionRules& rules);
/// The same for a rig that is compared in one quantity and leaves something there: floors grow to what the richest
/// explanation leaves, and a name stays while it takes enough of what the names before it leave. Unknown where the
/// names together take less than `taken_share`.
Decision decide_in_one_quantity(ResidualModel& model, const Search& search, const DecisionRules& rules);

}  // namespace pneuservo
