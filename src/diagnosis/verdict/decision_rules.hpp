// The limits that a verdict rests on, for the search and the decision alike.
#pragma once
#include <cstddef>

namespace pneuservo {

/// Every limit that a verdict rests on. The search asks no more of a name than the decision will.
struct DecisionRules {
  double alarm_gain = 25;           ///< in log evidence: the least that a first name must bring
  double next_gain = 60;            ///< and one more name
  double next_gain_at_floor = 100;  ///< the same where every channel is at its floor already: the model's own error
  double next_share = 2e-5;         ///< of the first name's gain
  double third_share = 0.02;        ///< the same for every name after the second
  double screened_share = 0.3;      ///< of a further name's gain that its linear screening shows at least
  double standard_errors = 5;       ///< the least size of one more effect, or of what a law has beyond a simpler one
  double told_errors = 1;  ///< of a law beyond a simpler one: likelier there than not, it is that one's rival
  double floor_level = 1.25;  ///< residual of a channel in sigma: above it something is left
  double line_ratio = 60;  ///< of a spectral line's power to its neighbours'
  double line_amplitude = 0.4;  ///< of a sample's noise and floor: smaller lines are of no account
  double line_level = 0.3;  ///< channels below it have no lines
  double held_out_excess = 1.4;  ///< chi2 a row on held-out stretches over that on fitted ones
  double taken_share = 0.6;  ///< of the squared mismatch above the floors: what names beside a remainder take at least
  double small_remainder = 1.6;  ///< that leaves no channel above this many sigma
  double nearly_all_share = 0.97;  ///< names that take it stay beside a larger remainder,
  double larger_remainder = 3;  ///< up to this many sigma; beside small physics, too, where more stood out before
  double small_held_out_excess = 2;  ///< and held-out stretches no worse than this
  double ambiguous_distance = 10;  ///< in log evidence
  double temperature = 3;  ///< log evidence over it makes probabilities
  double law_share = 0.1;  ///< a force below this share of a simpler law's does not make another law of it
  double most_sure = 0.97;  ///< small unmodelled physics is part of every probability
  double grid_error_gain = 15;  ///< in log evidence: names that bring less raise no alarm, whatever the grid does
  double doubted_gain = 15;  ///< in log evidence: what small unmodelled physics gains a name every other time
  double unknown_sure = 0.75;
  // A machine that leaves something everywhere (a little of everything that the model leaves out).
  double stretched_tolerance = 2.9;  ///< a fit beyond so many tolerances stands at the end of their range,
  std::size_t stretched_count = 3;  ///< and so many of them are no owner's errors any more
  std::size_t most_names = 3;  ///< sought; a verdict of so many is doubted as one beyond the tolerances is
  double doubted_left = 1.5;  ///< of the squared residual of what is doubted: the most that small physics leaves
  double refuted_level = 1.25;  ///< of the owner's mean square over the best name's, or over one
  double told_share = 0.2;  ///< of the same: what tells where an `unknown` sits; else no sine took more than a tenth
  double periodic_share = 0.5;  ///< of a force's squared residual in motion: what makes it a periodic force
  double swing_share = 0.5;  ///< of the squared mismatch: the least that a supply which swings takes
  double swing_left = 0.6;  ///< of what the best sine of another frequency leaves: the most that its own leaves
  double largest_remainder = 40;  ///< in sigma: more beside a name is no small physics
  double most_sure_beside = 0.85;  ///< of a name beside such a remainder
  // An axis or a part of one that is compared in one quantity.
  double next_of_left = 0.15;  ///< of the squared residual that the names before it leave: what one more must take
  double richer_of_all = 0.05;  ///< of all: what it must take beyond a parameter of the config that is off
  double richer_of_left = 0.33;  ///< of what a simpler law leaves: what a richer one must take
};

}  // namespace pneuservo
