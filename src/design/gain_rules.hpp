// Rules that find the gains of the PPD2 law from the linear model (2.3.1, 2.4 of the thesis; docs/design.md).
#pragma once
#include "design/linear_axis.hpp"

namespace pneuservo {

/// By the third-order loop s^3 + alpha w s^2 + beta w^2 s + w^3 with w^3 = Kp K: Ka = (alpha w - damping)/K,
/// Kv = (beta w^2 - wn^2)/K. position_gain_V_per_m > 0; alpha = beta = 2 are the thesis'.
Ppd2Gains alpha_beta_gains(const LinearAxis& axis, double position_gain_V_per_m, double alpha, double beta);

/// By two normalised coefficients of the loop of the axis' own order n, w^n = c_0: C_1 = c_1/w^(n-1) of s and
/// C_2 = c_2/w^(n-2) of s^2 (of the seventh order the thesis' C6 and C5, 2.34 and 2.35).
Ppd2Gains coefficient_gains(const LinearAxis& axis, double position_gain_V_per_m, double c_1, double c_2);

/// C_i = c_i/w^(n-i) of a loop, for i = 1 ... n-1 by rising power; w^n = c_0.
std::vector<double> normalised_coefficients(const Polynomial& closed_loop);

/// Velocity and acceleration gain that make the ITAE of the step least, from the alpha-beta gains on.
Ppd2Gains least_itae_gains(const LinearAxis& axis, double position_gain_V_per_m);

/// ITAE [s2] of the step of the loop with ideal derivatives, the reference at the position gain alone.
double itae_of_loop(const LinearAxis& axis, const Ppd2Gains& gains);

}  // namespace pneuservo
