// Linear systems in state-space form, sampled with a held and delayed input.
#pragma once
#include <complex>
#include <vector>

#include <Eigen/Core>

#include "design/linear_axis.hpp"

namespace pneuservo {

/// x' = A x + B u, y = C x in continuous time; x+ = A x + B u, y = C x + D u sampled.
struct StateSpace {
  Eigen::MatrixXd A, B, C, D;
  Eigen::MatrixXcd transfer(std::complex<double> at) const;  ///< C (at I - A)^-1 B + D; `at` is s or z
};

/// The axis from command [V] to position [m], velocity [m/s], acceleration [m/s2]; states those three, then two a lag.
StateSpace continuous_axis(const LinearAxis& axis);

/// Exact zero-order hold over period_s; the input acts delay_s >= 0 after the sample. A whole period of delay adds a
/// state. period_s > 0.
StateSpace held(const StateSpace& continuous, double period_s, double delay_s);

/// exp(A t), by scaling and squaring.
Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& A);

/// Eigenvalues of A, sorted by size.
std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXd& A);

}  // namespace pneuservo
