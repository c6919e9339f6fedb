// The limits that a verdict rests on, for the search and the decision alike.
#pragma once
#include <algorithm>
#include <cstddef>

namespace pneuservo {

/// Every limit that a verdict rests on. The search asks no more of a name than the decision will.
struct DecisionRules {
  double alarm_gain = 25;           ///< in log evidence: the least that a first name must bring
  double next_gain = 60;            ///< and one more name
  double next_gain_at_floor = 100;  ///< the same where every channel is at its floor already: the model's own error
  double third_share = 0.02;  ///< of the first name's gain: what every name after the second must bring
  double standard_errors = 5;       ///< the least size of one more effect, or of what a law has beyond a simpler one
  double told_errors = 1;  ///< of a law beyond a simpler one: likelier there than not, it is that one's rival
  double floor_level = 1.25;  ///< residual of a channel in sigma: above it something is left
  double line_ratio = 60;  ///< of a spectral line's power to its neighbours'
  double line_amplitude = 0.4;  ///< of a sample's noise and floor: smaller lines are of no account
  double worse_fit = 1.4;  ///< chi2 over that of another fit, or of held-out rows over fitted ones: clearly worse
  double taken_share = 0.6;  ///< of the squared mismatch: what names beside a remainder take at least
  double nearly_all = 0.97;  ///< of the same: names that take it stay beside a remainder,
  double small_remainder = 3;  ///< up to this many sigma; beside small physics, too, where more stood out before
  double small_held_out_excess = 2;  ///< and held-out stretches no worse than this
  double ambiguous_distance = 10;  ///< in log evidence
  double temperature = 3;  ///< log evidence over it makes probabilities
  double law_share = 0.1;  ///< a force below this share of a simpler law's does not make another law of it
  double most_sure = 0.97;  ///< small unmodelled physics is part of every probability
  double doubted_gain = 15;  ///< in log evidence: what small unmodelled physics gains a name every other time
  double unknown_sure = 0.75;
  // A machine that leaves something everywhere (a little of everything that the model leaves out).
  std::size_t most_names = 3;  ///< sought; a verdict of so many is doubted, or of so many tolerances at their ends
  double periodic_share = 0.5;  ///< of a squared mismatch: what a sine of the force or of the supply takes at least
  double swing_left =
      0.6;  ///< of what the best sine of another frequency leaves: the most that the supply's own leaves
  double told_share = 0.2;  ///< of a force's squared residual in motion: what tells where an `unknown` sits; else no
                            ///< sine took more than a tenth
  double largest_remainder = 40;  ///< in sigma: more beside a name is no small physics
  double most_sure_beside = 0.85;  ///< of a name beside such a remainder
  // An axis or a part of one that is compared in one quantity.
  double next_of_left = 0.15;  ///< of the squared residual that the names before it leave: what one more must take
  double richer_of_all = 0.05;  ///< of all: what it must take beyond a parameter of the config that is off
  double richer_of_left = 0.33;  ///< of what a simpler law leaves: what a richer one must take

  /// What one name more than `names` has to bring, where the first one brought this and each more `least`.
  double needed_beside(std::size_t names, double first_gain, double least) const {
    return names < 2 ? least : std::max(least, third_share * first_gain);
  }
};

}  // namespace pneuservo
