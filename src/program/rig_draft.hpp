// A config of a new axis from the numbers of its data sheets: what the sheets do not say gets a typical value that says
// so.
#pragma once
#include <string>
#include <vector>

#include "program/sheet_answers.hpp"

namespace pneuservo {

/// Error of the hardest motion over its way up to which a rig follows.
inline constexpr double permitted_share = 0.02;

/// Gains and motion, as numbers of the draft.
struct DraftNumbers {
  double force_gain_V_per_N = 1e-4, position_gain_N_per_m = 100.0, velocity_gain_Ns_per_m = 10.0;
  double feedforward_lead_s = 0.0, speed_mps = 0.01, acceleration_mps2 = 0.01;
  std::vector<std::string> notes;  ///< one comment line each, above the controller
};

/// The config as text.
std::string draft_text(const SheetAnswers& answers, const DraftNumbers& numbers);

/// The finished config: gains by margins, checked in simulation, and a motion that the valve can feed.
struct FinishedDraft {
  std::string text;
  std::vector<std::string> told;  ///< sentences for the owner
  bool is_fed = true;  ///< the error of the hardest motion stays within permitted_share of its way
};
/// Throws InputError with the keys of all answers that cannot be read.
FinishedDraft finish_draft(const SheetAnswers& answers);
/// The same of a pressure behind a hose.
FinishedDraft finish_pressure_draft(const SheetAnswers& answers);

}  // namespace pneuservo
