// Noise by differences of a signal, in the stretches where it is least or usual.
#include "diagnosis/recordings/noise_level.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace pneuservo {

namespace {

/// From there to the seventh, and in stretches half or twice as long, recorded commands have the same noise within a
/// tenth.
constexpr int highest_difference = 4;

/// A rest of a usual motion; and rows that tell a standard deviation to 11 %.
constexpr double stretch_s = 0.25;
constexpr std::size_t least_rows = 40;

/// Standard deviation that this share of the windows stays below.
double deviation_in_windows(const std::vector<double>& values, std::size_t window, double share) {
  std::vector<double> deviations;
  for (std::size_t from = 0; from + window <= values.size(); from += window) {
    double sum = 0, squares = 0;
    std::size_t n = 0;
    for (std::size_t k = from; k < from + window; ++k) {
      if (!std::isfinite(values[k])) continue;
      sum += values[k];
      squares += values[k] * values[k];
      ++n;
    }
    if (n < window / 2) continue;
    const double mean = sum / static_cast<double>(n);
    deviations.push_back(std::sqrt(std::max(0.0, squares / static_cast<double>(n) - mean * mean)));
  }
  if (deviations.empty()) return 0.0;
  const auto at = deviations.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(deviations.size()));
  std::nth_element(deviations.begin(), at, deviations.end());
  return *at;
}

/// The least that differences of order 1 to 4 tell. A course that is smooth over some samples leaves less and less of
/// itself in higher differences, white noise as much.
double noise_level(const std::vector<double>& signal, double period_s, double share) {
  const std::size_t window = std::max(least_rows, static_cast<std::size_t>(std::lround(stretch_s / period_s)));
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> differences(signal);
  double gain = 1;  // of white noise, squared: the central binomial coefficient
  for (int order = 1; order <= highest_difference; ++order) {
    for (std::size_t k = 0; k + 1 < differences.size(); ++k) differences[k] = differences[k + 1] - differences[k];
    if (!differences.empty()) differences.pop_back();
    gain *= 2.0 * (2 * order - 1) / order;
    least = std::min(least, deviation_in_windows(differences, window, share) / std::sqrt(gain));
  }
  return least;
}

}  // namespace

double quiet_noise(const std::vector<double>& signal, double period_s) { return noise_level(signal, period_s, 0.1); }

double usual_noise(const std::vector<double>& signal, double period_s) { return noise_level(signal, period_s, 0.5); }

}  // namespace pneuservo
