// Slow error of a model.
#include "diagnosis/residuals/slow_error.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "diagnosis/residuals/residual_model.hpp"

namespace pneuservo {

namespace {

/// The Kalman filter for an error at so many rows, by row and time of each.
std::vector<SlowErrorStep> steps_of(const SlowError& error, std::size_t count, const auto& row_of, const auto& time_s) {
  const double square = error.level * error.level;
  std::vector<SlowErrorStep> steps;
  steps.reserve(count);
  double variance = square;
  for (std::size_t k = 0; k < count; ++k) {
    const double kept = k > 0 ? std::exp(-(time_s(k) - time_s(k - 1)) / error.memory_s) : 1.0;
    variance = square + kept * kept * (variance - square);
    const double total = variance + 1.0;
    variance /= total;
    steps.push_back({row_of(k), kept, variance, std::sqrt(total)});
  }
  return steps;
}

/// Follows the error that is expected along a process; `change` replaces a row's value and returns its innovation.
void follow(const std::vector<SlowErrorStep>& steps, double* values, const auto& change) {
  double expected = 0;
  for (const SlowErrorStep& step : steps) {
    expected *= step.kept;
    expected += step.gain * change(values[step.row], expected, step.deviation);
  }
}

double take_from(double& value, double expected, double deviation) {
  const double innovation = value - expected;
  value = innovation / deviation;
  return innovation;
}

double give_back(double& value, double expected, double deviation) {
  const double innovation = value * deviation;
  value = innovation + expected;
  return innovation;
}

}  // namespace

double SlowError::whiten(std::span<const double> times_s, std::span<double> residuals) const {
  if (!(level > 0.0)) return 0.0;
  const auto steps = steps_of(
      *this, residuals.size(), [](std::size_t k) { return static_cast<Eigen::Index>(k); },
      [&](std::size_t k) { return times_s[k]; });
  follow(steps, residuals.data(), take_from);
  double log_sum = 0.0;
  for (const SlowErrorStep& step : steps) log_sum += std::log(step.deviation);
  return log_sum;
}

SlowErrors::SlowErrors(std::span<const ResidualRow> rows, std::span<const SlowError> of_channel) {
  std::map<std::pair<int, int>, std::vector<Eigen::Index>> by_process;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (!rows[i].over_recording)
      by_process[{rows[i].recording, rows[i].channel}].push_back(static_cast<Eigen::Index>(i));
  for (const auto& [process, of_process] : by_process) {
    const SlowError& error = of_channel[static_cast<std::size_t>(process.second)];
    if (!(error.level > 0.0)) continue;
    const auto row_of = [&at = of_process](std::size_t k) { return at[k]; };
    processes_.push_back(steps_of(error, of_process.size(), row_of,
                                  [&](std::size_t k) { return rows[static_cast<std::size_t>(row_of(k))].time_s; }));
  }
}

void SlowErrors::take_out(Eigen::Ref<Eigen::MatrixXd> columns) const {
  for (Eigen::Index c = 0; c < columns.cols(); ++c)
    for (const auto& steps : processes_) follow(steps, columns.col(c).data(), take_from);
}

void SlowErrors::put_back(Eigen::Ref<Eigen::MatrixXd> columns) const {
  for (Eigen::Index c = 0; c < columns.cols(); ++c)
    for (const auto& steps : processes_) follow(steps, columns.col(c).data(), give_back);
}

}  // namespace pneuservo
