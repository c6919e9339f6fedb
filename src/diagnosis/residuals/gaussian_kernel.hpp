// Gaussian smoothing of sampled signals and its derivatives: symmetric, without lag, exact on polynomials.
#pragma once
#include <span>
#include <vector>

namespace pneuservo {

/// Smooths with a Gaussian of standard deviation sigma, cut at 6 sigma, and gives derivatives of what is smoothed. The
/// kernel of derivative n gives n! on t^n and zero on lower powers, so the smoothed value of a line, the rate of a
/// parabola and the acceleration of a cubic come out exact.
class GaussianKernel {
 public:
  /// sigma_s >= 0.5 period_s > 0.
  GaussianKernel(double sigma_s, double period_s);

  double sigma_s() const { return sigma_s_; }
  /// Samples on each side that a result needs.
  std::size_t reach() const { return (taps_[0].size() - 1) / 2; }
  /// Derivative of the given order (0 to 3) of the smoothed signal at every sample [unit/s^order]. Closer than reach()
  /// to an end the first and last samples are taken on.
  std::vector<double> apply(std::span<const double> signal, int order) const;
  /// Of the smoothed value's weights: the rate that a unit step makes is this over the period.
  double largest_weight() const { return taps_[0][reach()]; }
  /// Of the smoothed value for a sample so far from it; 0 beyond the reach.
  double weight(std::size_t distance) const { return distance > reach() ? 0.0 : taps_[0][reach() + distance]; }
  /// Standard deviation of the mean of `count` neighbouring results for white noise of standard deviation 1 a sample.
  double noise_gain(int order, std::size_t count) const;

 private:
  double sigma_s_;
  std::vector<double> taps_[4];  ///< by order, from the oldest sample to the newest
};

/// Samples that are missing filled by the last one before them (the first one after, at the start): a kernel needs all.
std::vector<double> held_over_gaps(std::span<const double> signal);

}  // namespace pneuservo
