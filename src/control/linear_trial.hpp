// The servo table's linear plant behind an exact zero-order hold, and trials of a reference on it.
#pragma once
#include <array>
#include <functional>

#include <pneuservo/control/linear_servo_table.hpp>
#include <pneuservo/control/parameters.hpp>
#include <pneuservo/control/reference.hpp>

#include "control/matrix_exponential.hpp"

namespace pneuservo {

/// x''' + wn^2 x' = K y behind valve and line (seventh order; less where a lag has no frequency), in discrete time for
/// a command that is held over the period: exact. Cold.
class LinearTablePlant {
 public:
  /// period_s > 0.
  LinearTablePlant(const LinearServoTable& table, double period_s) noexcept;
  /// At rest at position x_m.
  void reset(double x_m) noexcept;
  /// One period under the command [V].
  void step(double command_V) noexcept;
  double position_m() const noexcept { return state_[0]; }
  double velocity_mps() const noexcept { return state_[1] / period_s_; }
  double acceleration_mps2() const noexcept { return state_[2] / (period_s_ * period_s_); }

 private:
  // x, x' T, x'' T^2, then spool and rate, line and rate in the length K T^3 a volt: entries alike in size.
  static constexpr std::size_t states = 7;
  SquareMatrix<states + 1> transition_{};
  std::array<double, states> state_{};
  double period_s_, length_per_V_;
};

/// What a controller of a trial sees at t: the plant itself.
using TrialController = std::function<double(double t_s, const LinearTablePlant& plant)>;

/// Largest |x_ref - x| [m] at the samples from 0 to 0.6 s after the reference's end. The plant starts at rest at the
/// reference's first value.
double linear_trial_error_m(const LinearServoTable& table, const Reference& reference, double period_s,
                            const TrialController& controller);

/// Whether the law brings the linear plant (order that the config's lags give) from 1 um off to rest within 4 s: gains
/// of a stable loop do.
bool linear_loop_settles(const Ppd2Parameters& parameters, const AxisParameters<double>& axis, double period_s);

}  // namespace pneuservo
