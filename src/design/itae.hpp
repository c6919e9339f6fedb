// The integral of time times absolute error of a step response, and the coefficients that make it least.
#pragma once
#include <vector>

#include "design/polynomial.hpp"

namespace pneuservo {

/// ITAE of the unit step of numerator/denominator, in s2: the integral of t |1 - y(t)|. Static gain 1, numerator of
/// lower order than denominator. Exact between the zeros of the error, which are found to rounding. Infinite where the
/// response does not settle within 1000 times the mean time constant.
double itae_of_step(const Polynomial& numerator, const Polynomial& denominator);

/// C_1 ... C_{n-1} of s^n + C_{n-1} s^{n-1} + ... + C_1 s + 1 by rising power.
using NormalisedCoefficients = std::vector<double>;

/// Those of Graham and Lathrop (1953), n = 3 ... 7; not quite minimal. Throws std::invalid_argument for other n.
NormalisedCoefficients classic_itae_coefficients(int order);
/// Those that make the ITAE least, found from the classic ones; n = 3 ... 7.
NormalisedCoefficients least_itae_coefficients(int order);
/// ITAE of 1/(s^n + ... + 1), dimensionless.
double itae_of_coefficients(const NormalisedCoefficients& coefficients);

}  // namespace pneuservo
