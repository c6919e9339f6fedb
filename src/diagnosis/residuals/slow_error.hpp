// Slow error of a model: what small unmodelled physics leaves in a channel, and residuals freed from it.
#pragma once
#include <span>

namespace pneuservo {

/// Residuals r_k = d_k + e_k in units of their sigma: e white with standard deviation 1, d an Ornstein-Uhlenbeck
/// process that keeps its value over `memory_s` and has the standard deviation `level`. Small faults of the valve add
/// up in the gas and fade slowly: they look like d, and would pass for evidence if every bin counted by itself.
struct SlowError {
  double memory_s = 1.0;
  double level = 0.0;  ///< in sigmas; 0: none

  /// Replaces residuals in the order of their times by the innovations of the Kalman filter for d over their standard
  /// deviation: white with variance 1 where the error is as supposed. Linear in the residuals. Returns the sum of the
  /// logarithms of those standard deviations.
  double whiten(std::span<const double> times_s, std::span<double> residuals) const;
};

}  // namespace pneuservo
