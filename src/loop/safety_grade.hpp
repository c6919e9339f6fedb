// What a config leaves out of its own supervision: limits that can never act, lines and sensors that are not there.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/rig/rig.hpp>

#include "loop/finding.hpp"

namespace pneuservo {

/// One finding for each limit that never acts (unsafe) or acts late, one for each line or sensor that a rig on devices
/// lacks, one for the areas of the piston. A rig without air has none. `load`
/// is needed for references of kind `file`.
std::vector<Finding> grade_safety(const Rig& rig, const LoadPositions& load);

/// Speed that air can give the slider: full supply over the whole stroke without any loss, [m/s].
double ballistic_speed_mps(const Rig& rig);

}  // namespace pneuservo
