// Learning of a command, in the frequency domain.
#include "pass/force_learning.hpp"

#include <Eigen/Dense>

namespace pneuservo {
namespace {

/// Steps that Anderson's acceleration remembers.
constexpr std::size_t most_remembered = 6;

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

}  // namespace

void ForceLearning::begin_stage(double cut_off_Hz) {
  command_changes_V_.clear();
  step_changes_V_.clear();
  last_step_V_.clear();
  cut_off_Hz_ = cut_off_Hz;
}

// w_{k+1} = w_k + f_k - (dW + dF) gamma, where gamma makes |f_k - dF gamma| smallest (Anderson 1965, type II).
std::vector<double> ForceLearning::next(const std::vector<double>& command_V, const std::vector<double>& left_N) {
  const std::vector<double> step_V = inverse_.input_for(left_N, cut_off_Hz_);
  if (!last_step_V_.empty()) {
    command_changes_V_.push_back(difference(command_V, last_command_V_));
    step_changes_V_.push_back(difference(step_V, last_step_V_));
    if (step_changes_V_.size() > most_remembered) command_changes_V_.pop_front(), step_changes_V_.pop_front();
  }
  last_command_V_ = command_V;
  last_step_V_ = step_V;
  std::vector<double> next_V(command_V);
  for (std::size_t i = 0; i < step_V.size(); ++i) next_V[i] += step_V[i];
  const std::size_t n = step_changes_V_.size();
  if (n == 0) return next_V;
  Eigen::MatrixXd changes(static_cast<Eigen::Index>(step_V.size()), static_cast<Eigen::Index>(n));
  for (std::size_t k = 0; k < n; ++k)
    changes.col(static_cast<Eigen::Index>(k)) =
        Eigen::Map<const Eigen::VectorXd>(step_changes_V_[k].data(), changes.rows());
  const Eigen::VectorXd share =
      changes.colPivHouseholderQr().solve(Eigen::Map<const Eigen::VectorXd>(step_V.data(), changes.rows()));
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < step_V.size(); ++i)
      next_V[i] -= share[static_cast<Eigen::Index>(k)] * (command_changes_V_[k][i] + step_changes_V_[k][i]);
  return next_V;
}

}  // namespace pneuservo
