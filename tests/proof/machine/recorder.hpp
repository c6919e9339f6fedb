// A machine under its user's loop, sampled as a logger would.
#pragma once

#include "machine.hpp"
#include "random.hpp"
#include "scenario.hpp"

#include <ostream>

namespace proof {

/// Position wanted at a time, and its speed.
std::pair<double, double> wanted(const MoveData& move, double time_s);

/// Runs the scenario; writes a row each period once the first seconds have passed. `commands`, where given, is the
/// command of each period in the place of the loop's.
void record(const Scenario& scenario, std::ostream& out, const std::vector<double>* commands = nullptr);

}  // namespace proof
