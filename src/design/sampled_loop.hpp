// A control loop as its sampled law and its held plant: closed-loop poles, margins, step response.
#pragma once
#include <complex>
#include <functional>
#include <vector>

#include "design/state_space.hpp"

namespace pneuservo {

/// Plant (command to measurements) and law (measurements, then the reference, to the command); the law acts without
/// delay of its own. The plant's first output is the position.
struct SampledLoop {
  StateSpace plant, law;
  double period_s = 0.0;

  /// Matrix of the closed loop with the law's command scaled by `gain`.
  Eigen::MatrixXd closed(double gain = 1.0) const;
  /// Its poles as s = ln(z)/period, sorted by size; a pole at z = 0 (a delay) is left out.
  std::vector<std::complex<double>> poles(double gain = 1.0) const;
  /// Loop transfer, positive for negative feedback: the loop is at its limit where it is -1.
  std::complex<double> open(double frequency_Hz) const;
};

/// Where the loop transfer crosses the negative real axis, or the unit circle.
struct LoopMargins {
  double gain_down = 0.0, gain_down_Hz = 0.0;  ///< the gain may fall to this; 0: to nothing
  double gain_up = 0.0, gain_up_Hz = 0.0;      ///< the gain may grow to this; infinite: to any
  double phase_deg = 0.0, phase_Hz = 0.0;      ///< the least at any crossing of gain one; NaN: none
};
/// Scans from 0.01 Hz to half the sampling rate. The figures mean what they say where the loop is stable.
LoopMargins margins_of(const std::function<std::complex<double>(double frequency_Hz)>& open, double highest_Hz);

/// What Nyquist's criterion says of a loop that begins at an integrator.
struct NyquistVerdict {
  bool is_stable = false;
  double nearest_Hz = 0.0;  ///< where the loop transfer comes next to -1
};
NyquistVerdict nyquist_verdict(const std::function<std::complex<double>(double frequency_Hz)>& open, double highest_Hz);

/// A response to a unit step, sampled.
struct StepResponse {
  std::vector<double> t_s, y;
  double overshoot = 0.0;      ///< of the final value 1
  double settling_s = 0.0;     ///< from then on within 2 %; NaN if not within the time shown
};
/// Of the position to a step of the reference, while nothing limits the command; sampled for duration_s.
StepResponse step_response(const SampledLoop& loop, double duration_s);

}  // namespace pneuservo
