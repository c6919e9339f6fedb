// From recordings of a machine to a config that controls it better.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "diagnosis/stop.hpp"
#include "record/reader.hpp"
#include "report/improvement.hpp"

namespace pneuservo {

struct ImproveOptions {
  int jobs = 0;  ///< threads; 0: as many as the machine has
  /// From 0 to below 1 in each call of the diagnosis, 1 where the prediction begins.
  std::function<void(double share, const std::string& what)> progress;
  StopQuestion stop;  ///< true ends early with what is there; a simulated run of the prediction is finished first
};

/// Throws InputError, with the config's name, for a rig or a law that has no command pass.
void require_improvable(const std::string& config, const Rig& rig);

/// Diagnoses the recordings, again from what was found while that gains, makes the command pass of the improved config
/// and predicts the error that remains. Throws InputError for recordings that cannot be used or are another rig's, and
/// DiagnosisStopped where nothing is known yet.
Improvement improve(const std::string& config, const Rig& rig, const std::vector<Recording>& recordings,
                    const ImproveOptions& options = {});

/// The improved config as a file has it, with what was found on top.
std::string improved_config_text(const Improvement& improvement);
/// What was found may be more than a limit of the config allows: then the text is refused where it is read. `source`
/// stands for the file.
void judge_improved_config(Improvement& improvement, const std::string& text, const std::string& source);

}  // namespace pneuservo
