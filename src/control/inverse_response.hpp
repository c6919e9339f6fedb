// The command that takes an error away: its spectrum over that of a measured pulse response, below a cut-off frequency.
#pragma once
#include <complex>
#include <cstddef>
#include <vector>

namespace pneuservo {

/// Q/H in the frequency domain, without delay: H the spectrum of a pulse response, Q(f) = 1/(1 + (f/f_c)^8).
class InverseResponse {
 public:
  InverseResponse() = default;
  /// `response`: answer to a pulse of one period; `ticks`: length of the signals. Cold.
  InverseResponse(std::vector<double> response, std::size_t ticks, double period_s);
  /// The input that gives this output, as far as it lies below the cut-off frequency. Cold.
  std::vector<double> input_for(const std::vector<double>& output, double cut_off_Hz) const;
  /// What of a signal lies below the cut-off frequency. Cold.
  std::vector<double> below(double cut_off_Hz, const std::vector<double>& signal) const;

 private:
  double low_pass(std::size_t i, double cut_off_Hz) const noexcept;
  template <class Gain> std::vector<double> filtered(const std::vector<double>& signal, Gain&& gain) const;

  std::size_t ticks_ = 0, length_ = 0;
  double period_s_ = 0.0;
  std::vector<std::complex<double>> response_;
};

}  // namespace pneuservo
