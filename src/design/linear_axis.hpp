// A pneumatic axis as a linear model: slider between air springs behind lags of valve and lines.
#pragma once
#include <array>
#include <vector>

#include <pneuservo/control/linear_servo_table.hpp>

#include "design/polynomial.hpp"

namespace pneuservo {

/// x''' + damping x'' + sum_i stiffness_i Q_i(s) x' = gain H(s) u with u the command [V],
/// H(s) = valve(s) (weight_1 line_1(s) + weight_2 line_2(s)), H(0) = 1. A lag of frequency 0 follows at once.
/// Q_i(s) = line_i(s) (1 + stiffening_i (1/line_i(s) - 1)): the chamber alone springs when it moves faster than its
/// line follows, chamber and line together when it moves slowly; stiffening 1: the line has no part in the spring.
struct LinearAxis {
  double gain_per_V = 0.0;              ///< K [m/(s3 V)], > 0
  double damping_per_s = 0.0;           ///< B/m [1/s]
  std::array<double, 2> stiffness_per_s2{};  ///< of each side; their sum is wn^2
  SecondOrderLag valve;
  std::array<SecondOrderLag, 2> lines;  ///< of side 1 and 2
  std::array<double, 2> weights{0.5, 0.5};
  std::array<double, 2> stiffening{1.0, 1.0};  ///< fast over slow stiffness, >= 1

  double natural_frequency_squared() const { return stiffness_per_s2[0] + stiffness_per_s2[1]; }
  /// One lag stands for both lines.
  bool lines_alike() const;
  /// 3 and two for each lag.
  int order() const;
  /// x/u = gain numerator/open_loop; the numerator is 1 at s = 0, open_loop begins with wn^2 s.
  Polynomial numerator() const;
  Polynomial open_loop() const;
  /// H = numerator/lag_denominator.
  Polynomial lag_denominator() const;
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
