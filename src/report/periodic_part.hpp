// The periodic part of a signal that a reference does not explain: what an oscillating loop makes by itself.
#pragma once
#include <span>
#include <vector>

namespace pneuservo {

/// The strongest line of what is left of a signal; amplitudes in the signal's unit.
struct PeriodicPart {
  double frequency_Hz = 0.0;
  double amplitude = 0.0;      ///< over the whole signal
  double share = 0.0;          ///< of the power that is left, in this line and its harmonics
  double growth = 0.0;  ///< of all that is left, second half over first: swings that come and go with the motion last
  double left_rms = 0.0;  ///< of all that is left
};

/// What is left of `signal` after a fit by least squares on the reference and its speed, at lags up to 0.6 s, products
/// of both, and for a reference of sines (`lines_Hz`) their harmonics. Both are even, period_s apart, and end together;
/// what the reference has more is its history. Nothing (zeros) where there are fewer than 64 samples.
std::vector<double> left_over(const std::vector<double>& signal, const std::vector<double>& reference, double period_s,
                              const std::vector<double>& lines_Hz);

/// Amplitude of the line at a frequency, in cycles a sample, behind a Hann window.
double line_amplitude(std::span<const double> signal, double turns_per_sample);

/// The strongest line of a signal without mean or trend.
PeriodicPart periodic_part(const std::vector<double>& left, double period_s);

}  // namespace pneuservo
