// Recordings cut where their inputs are missing: what lies behind a gap begins anew.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

using TimeSpan = std::pair<double, double>;  ///< from and to [s]

/// The rows within a span, with all else that belongs to the recording but its problems.
Recording part_of(const Recording& recording, const TimeSpan& span);
/// How far a column goes within a span, up and down added, seen every 20 ms [unit of the column].
double way_of(const Recording& recording, const std::string& column, const TimeSpan& span);
/// The part of this length in which x_m goes furthest.
Recording most_moving_part(const Recording& recording, double seconds);

/// Throws InputError where rows are so far apart or so near that their times are in another unit.
void refuse_intervals(const Rig& rig, const std::vector<Recording>& recordings);

/// The stretches that can be compared, each a recording of its own with its own start. A recording without gaps comes
/// back as it is. What is left out, and every cut, is told in `notes`. Rigs that are simulated over uneven rows are not
/// cut. Throws InputError where no stretch is long enough.
std::vector<Recording> compared_stretches(const Rig& rig, std::vector<Recording> recordings,
                                          std::vector<std::string>& notes);

}  // namespace pneuservo
