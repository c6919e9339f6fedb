// Zero-phase high-pass of a recorded signal: what swings faster than the motion, without a shift in time.
#pragma once
#include <vector>

namespace pneuservo {

/// Butterworth high-pass of second order with its corner at `corner_Hz`, run forward and backward: no phase, and an
/// amplitude of (f/f_c)^4 / (1 + (f/f_c)^4), 1/2 at the corner. The ends are extended by their point reflection
/// (2 y_0 - y_k), up to three periods of the corner, so that neither offset nor slope rings there; a ripple that is cut
/// off at its crest still does, for about one period of the corner. Samples are `period_s` apart and finite; the
/// bilinear transform is warped to keep the corner in place.
/// Nothing is left (zeros) where the corner is not below half the sampling frequency.
std::vector<double> zero_phase_high_pass(const std::vector<double>& samples, double period_s, double corner_Hz);

}  // namespace pneuservo
