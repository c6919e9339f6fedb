// Slow error of a model: what small unmodelled physics leaves in a channel, and residuals freed from it.
#pragma once
#include <span>
#include <vector>

#include <Eigen/Core>

namespace pneuservo {

struct ResidualRow;

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

/// One row of a slow error's process: how much of the error is kept since the row before, which part of an innovation
/// joins it, and the innovation's standard deviation.
struct SlowErrorStep {
  Eigen::Index row;
  double kept, gain, deviation;
};

/// The slow errors of a model's channels, in each recording a process of its own; rows over a whole recording have
/// none.
class SlowErrors {
 public:
  /// Rows of one channel and recording are in the order of their times. `of_channel`: the error of each channel.
  SlowErrors(std::span<const ResidualRow> rows, std::span<const SlowError> of_channel);

  /// Residuals or derivatives of the rows, a column each, as SlowError::whiten makes them.
  void take_out(Eigen::Ref<Eigen::MatrixXd> columns) const;
  /// The same back: what take_out has made them of.
  void put_back(Eigen::Ref<Eigen::MatrixXd> columns) const;

 private:
  std::vector<std::vector<SlowErrorStep>> processes_;
};

}  // namespace pneuservo
