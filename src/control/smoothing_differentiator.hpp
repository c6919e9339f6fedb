// Derivative of evenly sampled values by the least-squares cubic through a window around each of them.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace pneuservo {

/// y'(t_i) = sum_k c_k (y_{i+k} - y_{i-k}), c_k from the normal equations of the odd part a k + b k^3: exact for
/// polynomials to the fourth degree, and its gain is bounded however fine the grid is. At the ends of the row the
/// values are taken to rest.
class SmoothingDifferentiator {
 public:
  /// half_width >= 2 samples on each side; step_s > 0.
  SmoothingDifferentiator(int half_width, double step_s) : weights_(static_cast<std::size_t>(half_width) + 1) {
    double s2 = 0.0, s4 = 0.0, s6 = 0.0;
    for (int k = 1; k <= half_width; ++k) {
      const double q = static_cast<double>(k) * k;
      s2 += 2.0 * q;
      s4 += 2.0 * q * q;
      s6 += 2.0 * q * q * q;
    }
    const double determinant = s2 * s6 - s4 * s4;
    for (int k = 1; k <= half_width; ++k)
      weights_[static_cast<std::size_t>(k)] = (s6 * k - s4 * k * k * k) / (determinant * step_s);
  }

  void operator()(const std::vector<double>& y, std::vector<double>& rate) const {
    const auto n = static_cast<std::ptrdiff_t>(y.size()), w = static_cast<std::ptrdiff_t>(weights_.size()) - 1;
    rate.resize(y.size());
    const double* const weight = weights_.data();
    for (std::ptrdiff_t i = 0; i < n; ++i) {
      double sum = 0.0;
      if (i >= w && i + w < n) {
        const double* const middle = y.data() + i;
        for (std::ptrdiff_t k = 1; k <= w; ++k) sum += weight[k] * (middle[k] - middle[-k]);
      } else {
        for (std::ptrdiff_t k = 1; k <= w; ++k) {
          const auto after = static_cast<std::size_t>(std::min(i + k, n - 1));
          sum += weight[k] * (y[after] - y[static_cast<std::size_t>(std::max<std::ptrdiff_t>(i - k, 0))]);
        }
      }
      rate[static_cast<std::size_t>(i)] = sum;
    }
  }

 private:
  std::vector<double> weights_;
};

}  // namespace pneuservo
