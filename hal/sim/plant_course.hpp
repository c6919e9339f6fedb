// The plant alone on a recorded command: what it does, without sensors.
#pragma once
#include <vector>

#include <pneuservo/core/signal.hpp>
#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// A value a row of the recording: what ideal sensors show as the row begins, and the command that is held in it.
struct PlantCourse {
  PerSignal<std::vector<double>> measured;  ///< those of channel_signals
  std::vector<double> v_mps, u1_V, u2_V;    ///< one valve: u1_V alone
};

/// The plant starts at the recording's first position and pressures, at rest. Throws InputError where the recording
/// lacks the command, or has a gap in it that is longer than the axis takes for its stroke.
PlantCourse simulate_plant(const Rig& rig, const Recording& recording);

}  // namespace pneuservo
