// A pneumatic axis as a linear model: slider between air springs behind lags of valve and lines.
#pragma once
#include <array>
#include <vector>

#include <pneuservo/control/linear_servo_table.hpp>

#include "design/polynomial.hpp"

namespace pneuservo {

/// x''' + damping x'' + stiffness x' = gain H(s) u with u the command [V] and
/// H(s) = valve(s) (weight_1 line_1(s) + weight_2 line_2(s)), H(0) = 1. A lag of frequency 0 follows at once.
struct LinearAxis {
  double gain_per_V = 0.0;              ///< K [m/(s3 V)], > 0
  double damping_per_s = 0.0;           ///< B/m [1/s]
  double stiffness_per_s2 = 0.0;        ///< wn^2 [1/s2]
  SecondOrderLag valve;
  std::array<SecondOrderLag, 2> lines;  ///< of side 1 and 2; alike: one lag in the model
  std::array<double, 2> weights{0.5, 0.5};

  bool lines_alike() const;
  /// 3 and two for each lag.
  int order() const;
  /// H = numerator/denominator; both are 1 at s = 0.
  Polynomial lag_numerator() const;
  Polynomial lag_denominator() const;
  /// s^3 + damping s^2 + stiffness s.
  Polynomial actuator() const;
};

/// The servo table, both sides alike: orders 3 (no lags), 5 (one), 7 (both).
LinearAxis linear_axis(const LinearServoTable& table);

/// Without lags: the third-order model.
LinearAxis without_lags(LinearAxis axis);
/// One lag that agrees with H up to s^2 (w0 = 1/sqrt(a2), zeta0 = a1 w0/2 of 1/H = 1 + a1 s + a2 s^2 + ...): the
/// fifth-order model. The feedforward needs H at low frequency. An axis without lags stays as it is.
LinearAxis matched_at_low_frequency(const LinearAxis& axis);
/// Characteristic polynomial of the PPD2 loop with ideal derivatives, by rising power, monic.
Polynomial closed_loop(const LinearAxis& axis, const Ppd2Gains& gains);

/// One lag with the pair of closed-loop poles that stands fourth from the imaginary axis, as section 2.3.3 of the
/// thesis reduces: what decays faster is left out. It keeps the line and loses the phase of the valve.
LinearAxis reduced_by_pole_distance(const LinearAxis& axis, const Ppd2Gains& gains);

/// c_1 ... c_order of r = sum c_i x_ref^(i), the inverse of the closed loop up to its order (2.42, 2.43).
std::vector<double> inverse_of_closed_loop(const LinearAxis& axis, const Ppd2Gains& gains);

}  // namespace pneuservo
