// Slow error of a model.
#include "diagnosis/residuals/slow_error.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "diagnosis/residuals/residual_model.hpp"

namespace pneuservo {

namespace {

/// Kalman filter for the error: its variance, and what each row does to it.
struct SlowErrorFilter {
  const SlowError& error;
  double variance = error.level * error.level;

  double kept_over(double time_s) const { return std::exp(-time_s / error.memory_s); }
  void keep(double kept) {
    const double level = error.level * error.level;
    variance = level + kept * kept * (variance - level);
  }
  /// Variance of the innovation; the error's own is what the row leaves of it.
  double see_row() {
    const double total = variance + 1.0;
    variance /= total;
    return total;
  }
};

}  // namespace

double SlowError::whiten(std::span<const double> times_s, std::span<double> residuals) const {
  if (!(level > 0.0)) return 0.0;
  SlowErrorFilter filter{*this};
  double expected = 0.0, log_sum = 0.0;
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    if (k > 0) {
      const double kept = filter.kept_over(times_s[k] - times_s[k - 1]);
      expected *= kept;
      filter.keep(kept);
    }
    const double total = filter.see_row(), innovation = residuals[k] - expected;
    expected += filter.variance * innovation;
    residuals[k] = innovation / std::sqrt(total);
    log_sum += 0.5 * std::log(total);
  }
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
    SlowErrorFilter filter{error};
    std::vector<Step>& steps = processes_.emplace_back();
    double before_s = rows[static_cast<std::size_t>(of_process.front())].time_s;
    for (const Eigen::Index at : of_process) {
      const double time_s = rows[static_cast<std::size_t>(at)].time_s, kept = filter.kept_over(time_s - before_s);
      filter.keep(kept);
      const double total = filter.see_row();
      steps.push_back({at, kept, filter.variance, std::sqrt(total)});
      before_s = time_s;
    }
  }
}

void SlowErrors::take_out(Eigen::Ref<Eigen::MatrixXd> columns) const {
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    double* column = columns.col(c).data();
    for (const std::vector<Step>& steps : processes_) {
      double expected = 0;
      for (const Step& step : steps) {
        expected *= step.kept;
        const double innovation = column[step.row] - expected;
        expected += step.gain * innovation;
        column[step.row] = innovation / step.deviation;
      }
    }
  }
}

void SlowErrors::put_back(Eigen::Ref<Eigen::MatrixXd> columns) const {
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    double* column = columns.col(c).data();
    for (const std::vector<Step>& steps : processes_) {
      double expected = 0;
      for (const Step& step : steps) {
        expected *= step.kept;
        const double innovation = column[step.row] * step.deviation;
        column[step.row] = innovation + expected;
        expected += step.gain * innovation;
      }
    }
  }
}

}  // namespace pneuservo
