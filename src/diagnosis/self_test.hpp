// The self-test of a verdict: machines as the answer has them, played along the recorded motion and diagnosed by the
// same config. How often they get the same answer says what the answer's probability is worth on these recordings.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/diagnosis.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// What a machine is to do again.
struct RecordedMotion {
  std::string path;
  std::vector<double> time_s, position_m;  ///< from time 0; the reference where it was recorded, else smoothed
  std::vector<std::string> columns;        ///< that the recording has
  std::vector<std::pair<std::string, double>> changed;
  bool is_held_out = false;
};
/// Nothing of a recording without even rows or without a position.
std::vector<RecordedMotion> motions_of(const std::vector<Recording>& recordings);

/// Runs a rig in closed loop along positions. Nothing where the run ends in a fault or the rig cannot be simulated.
using FollowingMachine = std::function<std::optional<Recording>(const Rig& rig, const RecordedMotion& motion)>;
/// Diagnoses recordings by the owner's config.
using DiagnoseAgain = std::function<Diagnosis(std::vector<Recording> recordings)>;

/// Plays `machines` of them, each with noise of its own, and lowers every answer's probability to the share of them
/// that got it. Not of an `unknown` without a table: its physics is not known. A sentence says why there is none.
void add_self_test(const Rig& configured, const std::vector<RecordedMotion>& motions, int machines,
                   const FollowingMachine& play, const DiagnoseAgain& again, Diagnosis& out);

}  // namespace pneuservo
