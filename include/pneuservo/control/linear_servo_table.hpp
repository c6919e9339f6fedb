// Linear models of the servo table, third to seventh order, and the inverse that its feedforward is made of
// (docs/physics/ppd2.md).
#pragma once
#include <array>

namespace pneuservo {

template <class S> struct AxisParameters;

/// 1 / (1 + 2 zeta s/w + s^2/w^2): spool, line, or what stands for both. Frequency 0: no lag at all.
struct SecondOrderLag {
  double natural_frequency_rad_per_s = 0.0;
  double damping_ratio = 0.0;

  /// Coefficient of s in the denominator [s].
  double slope_s() const noexcept {
    return natural_frequency_rad_per_s > 0.0 ? 2.0 * damping_ratio / natural_frequency_rad_per_s : 0.0;
  }
  /// Coefficient of s^2 in the denominator [s2].
  double curvature_s2() const noexcept {
    return natural_frequency_rad_per_s > 0.0 ? 1.0 / (natural_frequency_rad_per_s * natural_frequency_rad_per_s) : 0.0;
  }
};

/// x''' + wn^2 x' = K u_s with u_s the spool [V] behind valve and line (2.9, 2.18).
struct LinearServoTable {
  double gain_per_V = 0.0;                      ///< K = K_n K_sv wn^2 [m/(s3 V)], > 0
  double natural_frequency_squared = 0.0;       ///< wn^2 [1/s2] of the slider between both air springs
  double discharge_ratio = 0.0;                 ///< delta (2.8): discharge over charge flow at equilibrium
  SecondOrderLag line, valve;
};

/// Gains of the PPD2 law; position gain > 0.
struct Ppd2Gains {
  double position_V_per_m = 0.0, velocity_Vs_per_m = 0.0, acceleration_Vs2_per_m = 0.0;
};

/// Constants of the linear model at mid-stroke and equilibrium_pressure_Pa (P0, both chambers): wn^2 = 2 A^2 P0/(m V0);
/// delta = sqrt(1 - ((Pa/P0 - b)/(1 - b))^2) P0/Ps (2.8 with P0/Ps outside the root; 1 where the exhaust is choked);
/// K = (1 + delta) K_f Ps sqrt(R T)/(2 A P0) area_per_volt wn^2. A and V0 are the means of both sides. Cold; the
/// pressure lies between atmosphere and supply.
LinearServoTable linear_servo_table(const AxisParameters<double>& axis, double equilibrium_pressure_Pa,
                                    const SecondOrderLag& line) noexcept;

/// The one lag that agrees with two in series up to s^2: w0 = 1/sqrt(a2), zeta0 = a1 w0/2 (the fifth-order model).
SecondOrderLag low_frequency_match(const SecondOrderLag& first, const SecondOrderLag& second) noexcept;

/// Inverse of the open loop: u = sum_i a_i x^(i) [V s^i/m], a_0 = 0. Order 3 has no lag, 5 the matched one, 7 valve
/// and line; any other order: all zero (no feedforward).
std::array<double, 8> inverse_coefficients(const LinearServoTable& table, int order) noexcept;

/// Inverse of the closed loop (2.42, 2.43): r = sum_i c_i x_ref^(i) [s^i], c_0 = 1, with ideal derivatives fed back.
std::array<double, 8> feedforward_coefficients(const LinearServoTable& table, const Ppd2Gains& gains,
                                               int order) noexcept;

}  // namespace pneuservo
