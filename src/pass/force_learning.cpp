// Learning of a command, in the frequency domain.
#include "pass/force_learning.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <Eigen/Dense>
#include <unsupported/Eigen/FFT>

namespace pneuservo {
namespace {

/// Steps that Anderson's acceleration remembers.
constexpr std::size_t most_remembered = 6;
/// Order of the low-pass 1/(1 + (f/f_c)^order), which has no phase.
constexpr int low_pass_order = 8;

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

}  // namespace

ForceLearning::ForceLearning(const std::vector<double>& response_N_per_V, std::size_t ticks, double period_s)
    : ticks_(ticks), length_(std::bit_ceil(ticks + response_N_per_V.size())), period_s_(period_s) {
  std::vector<double> padded(response_N_per_V);
  padded.resize(length_);
  Eigen::FFT<double> fft;
  fft.fwd(response_, padded);
}

void ForceLearning::begin_stage(double cut_off_Hz) {
  command_changes_V_.clear();
  step_changes_V_.clear();
  last_step_V_.clear();
  gain_.resize(length_);
  for (std::size_t i = 0; i < length_; ++i) gain_[i] = low_pass(i, cut_off_Hz) / response_[i];
}

double ForceLearning::low_pass(std::size_t i, double cut_off_Hz) const noexcept {
  const double f_Hz = static_cast<double>(std::min(i, length_ - i)) / (static_cast<double>(length_) * period_s_);
  return 1.0 / (1.0 + std::pow(f_Hz / cut_off_Hz, low_pass_order));
}

std::vector<double> ForceLearning::filtered(const std::vector<double>& signal,
                                            const std::vector<std::complex<double>>& gain) const {
  std::vector<double> padded(signal), out;
  padded.resize(length_);
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, padded);
  for (std::size_t i = 0; i < length_; ++i) spectrum[i] *= gain[i];
  fft.inv(out, spectrum);
  out.resize(ticks_);
  return out;
}

std::vector<double> ForceLearning::below(double cut_off_Hz, const std::vector<double>& force_N) const {
  std::vector<std::complex<double>> gain(length_);
  for (std::size_t i = 0; i < length_; ++i) gain[i] = low_pass(i, cut_off_Hz);
  return filtered(force_N, gain);
}

// w_{k+1} = w_k + f_k - (dW + dF) gamma, where gamma makes |f_k - dF gamma| smallest (Anderson 1965, type II).
std::vector<double> ForceLearning::next(const std::vector<double>& command_V, const std::vector<double>& left_N) {
  const std::vector<double> step_V = filtered(left_N, gain_);
  if (!last_step_V_.empty()) {
    command_changes_V_.push_back(difference(command_V, last_command_V_));
    step_changes_V_.push_back(difference(step_V, last_step_V_));
    if (step_changes_V_.size() > most_remembered) command_changes_V_.pop_front(), step_changes_V_.pop_front();
  }
  last_command_V_ = command_V;
  last_step_V_ = step_V;
  std::vector<double> next_V(command_V);
  for (std::size_t i = 0; i < ticks_; ++i) next_V[i] += step_V[i];
  const std::size_t n = step_changes_V_.size();
  if (n == 0) return next_V;
  Eigen::MatrixXd changes(static_cast<Eigen::Index>(ticks_), static_cast<Eigen::Index>(n));
  for (std::size_t k = 0; k < n; ++k)
    changes.col(static_cast<Eigen::Index>(k)) =
        Eigen::Map<const Eigen::VectorXd>(step_changes_V_[k].data(), changes.rows());
  const Eigen::VectorXd share =
      changes.colPivHouseholderQr().solve(Eigen::Map<const Eigen::VectorXd>(step_V.data(), changes.rows()));
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < ticks_; ++i)
      next_V[i] -= share[static_cast<Eigen::Index>(k)] * (command_changes_V_[k][i] + step_changes_V_[k][i]);
  return next_V;
}

}  // namespace pneuservo
