// Which stretches of a recording no fit may see.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "record/reader.hpp"

namespace pneuservo {

/// Whether whole recordings are kept from the fits: then the others are fitted whole.
inline bool any_held_out(const std::vector<Recording>& recordings) {
  return std::any_of(recordings.begin(), recordings.end(), [](const Recording& r) { return r.is_held_out; });
}
/// Of one recording: all or nothing of it, or the last second of every four; of one stroke the last quarter of each of
/// its quarters.
struct HeldOut {
  bool whole_recordings = false, this_one = false;
  double every_s = 4.0;
  bool operator()(double time_s) const {
    return whole_recordings ? this_one : std::fmod(time_s, every_s) >= 0.75 * every_s;
  }
};
/// That of a recording of this length.
inline HeldOut held_out_of(bool whole_recordings, bool this_one, double length_s) {
  return {whole_recordings, this_one, length_s < 4.0 ? length_s / 4.0 : 4.0};
}
/// Length of a row of residuals.
inline constexpr double residual_bin_s = 0.01;
/// Time over which the model's own error stays alike, so that it counts once.
inline constexpr double floor_correlation_s = 0.1;

}  // namespace pneuservo
