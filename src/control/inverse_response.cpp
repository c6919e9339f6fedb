// A pulse response inverted below a cut-off frequency.
#include "control/inverse_response.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <unsupported/Eigen/FFT>

namespace pneuservo {
namespace {

/// Order of the low-pass 1/(1 + (f/f_c)^order), which has no phase.
constexpr int low_pass_order = 8;

}  // namespace

InverseResponse::InverseResponse(std::vector<double> response, std::size_t ticks, double period_s)
    : ticks_(ticks), length_(std::bit_ceil(ticks + response.size())), period_s_(period_s) {
  response.resize(length_);
  Eigen::FFT<double> fft;
  fft.fwd(response_, response);
}

double InverseResponse::low_pass(std::size_t i, double cut_off_Hz) const noexcept {
  const double f_Hz = static_cast<double>(std::min(i, length_ - i)) / (static_cast<double>(length_) * period_s_);
  return 1.0 / (1.0 + std::pow(f_Hz / cut_off_Hz, low_pass_order));
}

template <class Gain>
std::vector<double> InverseResponse::filtered(const std::vector<double>& signal, Gain&& gain) const {
  std::vector<double> padded(signal), out;
  padded.resize(length_);
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, padded);
  for (std::size_t i = 0; i < length_; ++i) spectrum[i] *= gain(i);
  fft.inv(out, spectrum);
  out.resize(ticks_);
  return out;
}

std::vector<double> InverseResponse::input_for(const std::vector<double>& output, double cut_off_Hz) const {
  return filtered(output, [&](std::size_t i) { return low_pass(i, cut_off_Hz) / response_[i]; });
}

std::vector<double> InverseResponse::below(double cut_off_Hz, const std::vector<double>& signal) const {
  return filtered(signal, [&](std::size_t i) { return low_pass(i, cut_off_Hz); });
}

}  // namespace pneuservo
