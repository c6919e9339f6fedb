// Grading what a config asks for. What contradicts itself is refused when it is read (config/rig_checks.hpp); these
// findings say where allowed values will work badly on a machine.
#pragma once
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "loop/finding.hpp"

namespace pneuservo {

/// What noise and quanta of a pd_force law's sensors make of its command from one period to the next, rms.
double command_noise_rms_V(const Rig& rig);

/// One function a grade; each adds its findings. bad: the run will not do what the config says.
std::vector<Finding> grade_rig(const Rig& rig);

}  // namespace pneuservo
