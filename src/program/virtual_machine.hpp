// A rig run in closed loop on the simulated backend, as a recording in memory: what a proposed experiment would give.
#pragma once
#include <optional>

#include <pneuservo/rig/rig.hpp>

#include "diagnosis/self_test.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// Controller, loop, plant and sensors of `run`; columns t_s, x_m, u_V and the six pressures that there are. Nothing
/// where the run ends in a fault, or for a rig that `run` does not simulate.
std::optional<Recording> record_virtual_run(const Rig& rig);
/// The same along these positions.
std::optional<Recording> follow_virtually(const Rig& rig, const RecordedMotion& motion);

}  // namespace pneuservo
