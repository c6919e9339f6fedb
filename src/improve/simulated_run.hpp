// One run of a law on a simulated machine, with its figures.
#pragma once
#include <pneuservo/rig/rig.hpp>

#include "report/run_result.hpp"

namespace pneuservo {

/// One run in simulation without supervision of the motion, which is judged afterwards; the payload is the machine's,
/// the law believes the config's. Throws std::invalid_argument where the law cannot follow the reference.
RunResult simulated_run(const Rig& rig, double payload_kg);
/// The same on another machine.
RunResult simulated_run(const Rig& rig, const Rig& machine);

}  // namespace pneuservo
