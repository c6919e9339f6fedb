// Recorded channels against the range and the steps of their own sensor: clipped, wrapped, coarse, repeated.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// A counter that begins again within the motion: the turns are added, and told.
void unwrap_position(const Rig& rig, Recording& recording, std::vector<std::string>& notes);

/// Channels that come in steps whose rounding exceeds what the config says of their sensor: the rig takes the step as
/// quantum, which is told. Throws InputError where the step is coarser than a config may say.
void take_resolution(Rig& rig, const Recording& recording, std::vector<std::string>& notes);

/// Two columns of which one follows from the other without noise of its own; a command and the force of it may.
void refuse_repeated_channels(const Rig& rig, const Recording& recording);

/// Rows at the end of the sensor's range: values pile up at the largest or smallest, which the sensor's noise rules out
/// (frozen_rows: so many equal ones in a row it does; 0: none), or it is reached and left with a kink. At most two
/// ends.
struct ClippedEnd {
  double value = 0;
  std::size_t rows = 0;
};
/// slack: step that noise and quantum make.
std::vector<ClippedEnd> clipped_ends(const std::vector<double>& values, double slack, int frozen_rows);

}  // namespace pneuservo
