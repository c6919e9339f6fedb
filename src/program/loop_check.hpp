// What the loop of a config is worth before it moves anything: margins of its linear model, and a simulated minute.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "loop/finding.hpp"

namespace pneuservo {

/// Margins at the positions that the reference reaches and at +-80 % of the stroke, then the nonlinear axis in
/// simulation: at rest at each of these positions, and along the reference; all with the config's payload and, where it
/// is stated, limits.payload_max_kg. unsafe: unstable, swinging or at an end stop where the reference goes; bad: it
/// does not follow; acceptable: it lags, hunts a little, or only fails where the reference does not go.
std::vector<Finding> grade_loop(const Rig& rig);

/// The part of it that simulates: at rest and along the reference. Throws std::invalid_argument where the law cannot
/// follow the reference.
std::vector<Finding> grade_simulated_loop(const Rig& rig);

/// Where the linear loop is unstable within the reference's reach, in one sentence; empty: nowhere.
std::string unstable_loop_words(const Rig& rig);

/// Throws InputError where a reference from a file leaves the stroke; others are refused where the config is read.
void require_reference_in_stroke(const std::string& config, const Rig& rig);

/// Goes on with the formula, and says so, where no command pass can be made and the config wants it so. Throws
/// InputError where it does not.
void heed_pass(const std::string& config, Rig& rig);

/// What a run may do although it is not safe.
struct AllowedRisks {
  bool unstable_loop = false;
};

/// Before a run, in milliseconds. On devices: throws InputError with the first limit that can never act (grade_safety),
/// and where the loop is unstable (unstable_loop_words). Else: unstable_loop_words on standard error.
void heed_loop(const std::string& config, const Rig& rig, bool on_devices, const AllowedRisks& allowed);

}  // namespace pneuservo
