// Grading the kernel's CAN interface that a config names: there, up, at the config's bit rate, with a short queue.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include <pneuservo/hal/bus_interface.hpp>

#include "loop/finding.hpp"

namespace pneuservo {

/// Grades it for a loop that sends the newest command or none. `found`: none if there is no such interface.
std::vector<Finding> grade_bus_interface(const std::string& name, const std::optional<BusInterface>& found,
                                         double bit_rate_bps);

}  // namespace pneuservo
