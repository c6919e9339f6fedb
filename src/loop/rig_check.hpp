// Checking what a config asks for: each value is allowed by itself, these findings say where values do not fit together.
#pragma once
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "loop/finding.hpp"

namespace pneuservo {

/// One function a check; each adds its findings. bad: the run will not do what the config says.
std::vector<Finding> check_rig(const Rig& rig);

}  // namespace pneuservo
