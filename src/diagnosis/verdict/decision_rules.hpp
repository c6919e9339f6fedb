// The limits that a verdict rests on, for the search and the decision alike.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pneuservo {

/// Every limit that a verdict rests on. The search asks no more of a name than the decision will.
struct DecisionRules {
  double alarm_gain = 25;       ///< in log evidence: the least that a first name must bring
  double next_gain =
      100;        ///< and one more name; and a spectral line: its power over its neighbours' is its log evidence
  double small_share = 0.02;  ///< of the first name's gain: what every name after the second must bring; of a simpler
                              ///< law's force, or of all the mismatch: less counts for nothing
  double standard_errors = 5;  ///< the least size of one more effect, or of what a law has beyond a simpler one
  double told_errors = 1;  ///< of a law beyond a simpler one: likelier there than not, it is that one's rival
  double floor_level = 1.25;  ///< residual of a channel in sigma: above it something is left
  double line_amplitude = 0.4;  ///< of a sample's noise and floor: smaller lines are of no account
  double worse_fit = 1.5;  ///< chi2 over that of another fit, or of held-out rows over fitted ones: clearly worse
  double taken_share = 0.6;  ///< of the squared mismatch: what names or a sine take at least with a remainder beside
  double small_remainder = 3;  ///< residual of a channel in sigma: below it a remainder may stand beside names
  double temperature = 3;  ///< log evidence over it makes probabilities
  double doubted_gain = 15;  ///< in log evidence: what small unmodelled physics gains a name every other time
  double most_sure = 0.97;  ///< of every probability: the rest is small unmodelled physics; names that take as much of
                            ///< the squared mismatch stay beside a remainder
  double most_sure_beside = 0.8;  ///< the same where more than the floors is left, and of an `unknown`
  std::size_t most_names = 3;  ///< sought; a verdict of so many is doubted, or of so many tolerances at their ends

  /// In log evidence: a rival nearer than this is likelier than all that `most_sure` leaves.
  double ambiguous_distance() const { return -temperature * std::log(1 - most_sure); }
  /// What one name more than `names` has to bring, where the first one brought this.
  double needed_beside(std::size_t names, double first_gain) const {
    if (names == 0) return alarm_gain;
    return names == 1 ? next_gain : std::max(next_gain, small_share * first_gain);
  }
};

}  // namespace pneuservo
