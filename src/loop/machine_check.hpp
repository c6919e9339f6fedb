// Grading the machine for running in real time: what it permits, tried out, and what its settings promise.
#pragma once
#include <string>
#include <vector>

#include "loop/finding.hpp"
#include "loop/realtime.hpp"

namespace pneuservo {

/// All findings of this machine: rights tried on a scratch thread, then the settings of kernel and processors.
std::vector<Finding> check_machine(const RealTimeSettings& settings = {});

/// What a real-time thread was granted; one finding each for policy, memory lock, sleep states (and processor).
std::vector<Finding> check_rights(const RealTimeSettings& settings);

/// The settings below `root` (/proc, /sys; "" is this machine, a folder elsewhere is a test's) and the kernel's version
/// line as uname gives it. A setting that the kernel does not have is left out where its absence is harmless.
std::vector<Finding> check_settings(const std::string& root, const std::string& kernel_version);

}  // namespace pneuservo
