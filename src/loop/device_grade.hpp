// Grades what closes the valves of a rig on devices when this program is gone, and whether their outputs are read back.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "loop/finding.hpp"

namespace pneuservo {

/// Empty for a rig without devices.
std::vector<Finding> grade_devices(const Rig& rig);

/// What of it must be said before a run on devices begins: a line for each bad finding, empty for none.
std::string device_warning(const Rig& rig);

}  // namespace pneuservo
