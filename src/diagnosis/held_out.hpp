// Which stretches of a recording no fit may see.
#pragma once
#include <cmath>

namespace pneuservo {

/// The last second of every four.
inline bool is_held_out(double time_s) { return std::fmod(time_s, 4.0) >= 3.0; }
/// Length of a row of residuals.
inline constexpr double residual_bin_s = 0.01;
/// Time over which the model's own error stays alike, so that it counts once.
inline constexpr double floor_correlation_s = 0.1;

}  // namespace pneuservo
