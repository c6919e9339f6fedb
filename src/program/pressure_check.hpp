// What the loop of a pressure rig is worth before it runs: its margins, the valve's flow, and a simulated run.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "loop/finding.hpp"

namespace pneuservo {

/// unsafe: unstable; bad: a fault, or a step that never settles; acceptable: less margin than the derived gain has, or
/// an overshoot above 10 %.
std::vector<Finding> grade_pressure_loop(const Rig& rig);
/// In one sentence that the loop is unstable; empty: it is not.
std::string unstable_pressure_words(const Rig& rig);

}  // namespace pneuservo
