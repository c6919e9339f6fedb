// Slow error of a model.
#include "diagnosis/residuals/slow_error.hpp"

#include <cmath>

namespace pneuservo {

double SlowError::whiten(std::span<const double> times_s, std::span<double> residuals) const {
  if (!(level > 0.0)) return 0.0;
  double expected = 0.0, variance = level * level, log_sum = 0.0;
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    if (k > 0) {
      const double kept = std::exp(-(times_s[k] - times_s[k - 1]) / memory_s);
      expected *= kept;
      variance = level * level + kept * kept * (variance - level * level);
    }
    const double total = variance + 1.0, innovation = residuals[k] - expected;
    expected += variance / total * innovation;
    variance /= total;
    residuals[k] = innovation / std::sqrt(total);
    log_sum += 0.5 * std::log(total);
  }
  return log_sum;
}

}  // namespace pneuservo
