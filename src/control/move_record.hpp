// What a law remembers of the ticks of a move, to learn from it.
#pragma once
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pneuservo {

/// A tick of which nothing is remembered.
inline constexpr double not_recorded = std::numeric_limits<double>::quiet_NaN();

/// Slots that a late loop skipped get the values of the one before, 0 before the first. False: they are more than 1 %,
/// and the move teaches nothing.
inline bool fill_skipped(std::vector<double>& recorded) noexcept {
  std::size_t missing = 0;
  for (std::size_t k = 0; k < recorded.size(); ++k) {
    if (std::isfinite(recorded[k])) continue;
    ++missing;
    recorded[k] = k > 0 ? recorded[k - 1] : 0.0;
  }
  return missing <= recorded.size() / 100;
}

}  // namespace pneuservo
