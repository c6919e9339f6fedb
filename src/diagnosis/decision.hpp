// From fitted explanations to a verdict: how many effects are real, what is left over, how sure that is.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnosis.hpp"
#include "diagnosis/left_over.hpp"
#include "diagnosis/search.hpp"

namespace pneuservo {

/// Every limit that a verdict rests on.
struct DecisionRules {
  double alarm_gain = 25;           ///< in log evidence: the least that a first name must bring
  double next_gain = 60;            ///< and one more name
  double next_gain_at_floor = 300;  ///< the same where every channel is at its floor already: the model's own error
  double next_share = 0.003;        ///< of the first name's gain
  double third_share = 0.02;        ///< the same for every name after the second
  double standard_errors = 5;       ///< the least size of one more effect
  double floor_level = 1.25;        ///< residual of a channel in sigma: above it something is left
  double line_ratio = 60;           ///< of a spectral line's power to its neighbours'
  double line_amplitude = 0.4;      ///< of a sample's noise and floor: smaller lines are of no account
  double line_level = 0.3;          ///< channels below it have no lines
  double held_out_excess = 1.4;     ///< chi2 a row on held-out stretches over that on fitted ones
  double taken_share = 0.6;         ///< of the squared mismatch: names that take it stay beside a remainder
  double small_remainder = 1.6;     ///< that leaves no channel above this many sigma
  double small_held_out_excess = 2; ///< and held-out stretches no worse than this
  double ambiguous_distance = 10;   ///< in log evidence
  double temperature = 3;           ///< log evidence over it makes probabilities
  double most_sure = 0.97;          ///< small unmodelled physics is part of every probability
  double doubted_gain = 15;         ///< in log evidence: what small unmodelled physics gains a name every other time
  double unknown_sure = 0.75;
  // A machine that leaves something everywhere (a little of everything that the model leaves out).
  double refuted_level = 1.25;      ///< of the owner's mean square, in the floor that the best name leaves
  double periodic_share = 0.5;      ///< of a force's squared residual in motion: what makes it a periodic force
  double named_share = 0.5;         ///< of the squared residual of one channel: what a name must take there
  double farthest_parameter = 3;    ///< a parameter off by more than this factor has the pattern of something else
  double most_sure_beside = 0.85;   ///< of a name beside such a remainder
  double next_share_beside = 0.15;  ///< what one more name must bring, of the first's gain
  // An axis or a part of one that is compared in one quantity.
  double next_of_left = 0.15;   ///< of the squared residual that the names before it leave: what one more must take
  double richer_of_all = 0.05;  ///< of all: what it must take beyond a parameter of the config that is off
  double richer_of_left = 0.33; ///< of what a simpler law leaves: what a richer one must take
};

/// Residuals of one model over all rows, and what they say.
struct ModelLevels {
  Eigen::VectorXd residual;
  std::vector<ChannelLevel> channels;
  std::optional<SpectralLine> line;  ///< above the rules' ratio

  double chi2(bool held_out) const;
  double highest() const;
  /// Chi2 a row on held-out stretches over that on fitted ones; 1 where there are none or they are at their floor: the
  /// floor is wider at the start of a recording, so that fitted rows may stay further below it.
  double held_out_excess() const;
};
ModelLevels model_levels(ResidualModel& model, const Hypothesis& hypothesis, const DecisionRules& rules);

/// The chosen explanation (no members: the owner's model) and its rivals with as many members.
struct Decision {
  Verdict verdict = Verdict::consistent;
  const Explanation* chosen = nullptr;
  std::vector<const Explanation*> rivals;  ///< chosen first, then by evidence
  std::vector<double> probabilities;  ///< of the rivals
  ModelLevels levels;  ///< of the chosen
  double gain = 0;  ///< of the chosen over the owner's model, in log evidence
  std::string reason;  ///< of `unknown`; beside a name: what is left
  bool beside_remainder = false;  ///< the floors have grown with what is left
  double growth = 1;  ///< of squared floors: what evidence and variances are to be divided by
};

Decision decide(ResidualModel& model, const Search& search, const DecisionRules& rules);
/// Levels of the chosen explanation as it stands now, and the verdict that they leave.
void judge_what_is_left(ResidualModel& model, const Search& search, const DecisionRules& rules, Decision& decision);
/// The same for a search whose residuals were freed from the slow error that is left everywhere: names what takes most
/// of it, or says unknown. A name needs three things: it brings enough on the floor that the owner's model leaves; on
/// the floor that it leaves itself, the owner's model is refuted; and it takes most of some channel. A force that is
/// periodic while the slider moves has no name. Levels are taken of plain residuals.
Decision decide_beside_remainder(ResidualModel& model, const Search& search, const DecisionRules& rules);
/// The same for a rig that is compared in one quantity and leaves something there: floors grow to what the richest
/// explanation leaves, and a name stays while it takes enough of what the names before it leave. Unknown where the
/// names together take less than half.
Decision decide_in_one_quantity(ResidualModel& model, const Search& search, const DecisionRules& rules);
/// Of all explanations that say the same as this member of the chosen one, less what small unmodelled physics may gain.
double probability_of_member(const Decision& decision, const Search& search, std::size_t member,
                             const DecisionRules& rules);
/// Names that cannot be told from the chosen explanation's member.
std::vector<std::string> ambiguous_names(const Decision& decision, const Search& search, std::size_t member,
                                         const DecisionRules& rules);

}  // namespace pneuservo
