// What misfits of readings and wirings are held against.
#pragma once
#include <cmath>
#include <exception>
#include <limits>

namespace pneuservo {

inline constexpr double judged_s = 6;  ///< of each recording: some strokes
/// Misfit of the simulated pressures as recorded below which nothing is doubted: the geometric mean of the least that
/// 106 recordings of machines with faults miss by as they are wired (0.08), and with channels exchanged or reversed
/// (0.84).
inline constexpr double doubtful = 0.25;
inline constexpr double own_swing = 1.0;  ///< misfit of a constant, by the misfits' definitions
inline constexpr double infinite_misfit = std::numeric_limits<double>::infinity();

/// Infinite where it cannot be computed, or comes to nothing.
template <class Function> double misfit_or_infinite(const Function& misfit) {
  try {
    const double found = misfit();
    return std::isfinite(found) ? found : infinite_misfit;
  } catch (const std::exception&) { return infinite_misfit; }
}

}  // namespace pneuservo
