// Learning of a command, in the frequency domain.
#include "pass/force_learning.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <unsupported/Eigen/FFT>

namespace pneuservo {
namespace {

/// Steps that Anderson's acceleration remembers.
constexpr std::size_t most_remembered = 6;
/// Order of the low-pass 1/(1 + (f/f_c)^order), which has no phase.
constexpr int low_pass_order = 8;

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

/// Solves the symmetric a x = b by elimination; a is made safe by a small part of its diagonal.
std::vector<double> solve(std::vector<std::vector<double>> a, std::vector<double> b) {
  constexpr double safe_share = 1e-10;
  const std::size_t n = b.size();
  for (std::size_t i = 0; i < n; ++i) a[i][i] += safe_share * a[i][i] + 1e-300;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t row = i + 1; row < n; ++row) {
      const double factor = a[row][i] / a[i][i];
      for (std::size_t column = i; column < n; ++column) a[row][column] -= factor * a[i][column];
      b[row] -= factor * b[i];
    }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t column = i + 1; column < n; ++column) b[i] -= a[i][column] * b[column];
    b[i] /= a[i][i];
  }
  return b;
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
  std::vector<std::vector<double>> a(n, std::vector<double>(n));
  std::vector<double> b(n);
  for (std::size_t i = 0; i < n; ++i) {
    b[i] = dot(step_changes_V_[i], step_V);
    for (std::size_t j = 0; j <= i; ++j) a[i][j] = a[j][i] = dot(step_changes_V_[i], step_changes_V_[j]);
  }
  const std::vector<double> share = solve(std::move(a), std::move(b));
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < ticks_; ++i) next_V[i] -= share[k] * (command_changes_V_[k][i] + step_changes_V_[k][i]);
  return next_V;
}

}  // namespace pneuservo
