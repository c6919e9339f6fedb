// Linear systems in state-space form, sampled with a held and delayed input.
#include "design/state_space.hpp"

#include <cmath>

#include <Eigen/LU>

#include "control/matrix_exponential.hpp"
#include "design/eigenvalues.hpp"

namespace pneuservo {

namespace {

/// exp([[A, B], [0, 0]] t): the state's own motion beside what a constant input adds in t.
struct Held {
  Eigen::MatrixXd state, input;
};
Held hold(const StateSpace& system, double t) {
  const Eigen::Index n = system.A.rows(), m = system.B.cols();
  Eigen::MatrixXd joined = Eigen::MatrixXd::Zero(n + m, n + m);
  joined.topLeftCorner(n, n) = system.A * t;
  joined.topRightCorner(n, m) = system.B * t;
  const Eigen::MatrixXd e = matrix_exponential(joined);
  return {e.topLeftCorner(n, n), e.topRightCorner(n, m)};
}

/// Adds one lag driven by the row `input` of (states, command); returns the index of its output.
Eigen::Index add_lag(StateSpace& system, const SecondOrderLag& lag, Eigen::Index next, const Eigen::RowVectorXd& states,
                     double command) {
  // Scaled so that both states have the size of the signal: q' = w r, r' = w (input - q - 2 zeta r).
  const double w = lag.natural_frequency_rad_per_s;
  system.A(next, next + 1) = w;
  system.A.row(next + 1) = w * states;
  system.A(next + 1, next) -= w;
  system.A(next + 1, next + 1) -= 2.0 * lag.damping_ratio * w;
  system.B(next + 1, 0) = w * command;
  return next + 2;
}

}  // namespace

namespace {

/// The same matrix in states whose sizes are alike (Parlett and Reinsch): scaled by powers of two, which rounds
/// nothing, until rows and columns have the same norm. Poles near each other are found to far more digits then.
Eigen::MatrixXd balanced(Eigen::MatrixXd A) {
  for (bool moved = true; moved;) {
    moved = false;
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      const double column = A.col(i).lpNorm<1>() - std::fabs(A(i, i)), row = A.row(i).lpNorm<1>() - std::fabs(A(i, i));
      if (column == 0.0 || row == 0.0) continue;
      const double factor = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (factor * column + row / factor >= 0.95 * (column + row)) continue;
      A.col(i) *= factor;
      A.row(i) /= factor;
      moved = true;
    }
  }
  return A;
}

}  // namespace

Eigen::MatrixXcd StateSpace::transfer(std::complex<double> at) const {
  Eigen::MatrixXcd shifted = -A.cast<std::complex<double>>();
  shifted.diagonal().array() += at;
  return C.cast<std::complex<double>>() * shifted.partialPivLu().solve(B.cast<std::complex<double>>()) +
         D.cast<std::complex<double>>();
}

StateSpace continuous_axis(const LinearAxis& axis) {
  const Eigen::Index n = axis.order();
  StateSpace out{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, 1), Eigen::MatrixXd::Zero(3, n),
                 Eigen::MatrixXd::Zero(3, 1)};
  out.C.leftCols(3).setIdentity();
  out.A(0, 1) = out.A(1, 2) = 1.0;
  out.A(2, 2) = -axis.damping_per_s;
  Eigen::RowVectorXd spool = Eigen::RowVectorXd::Zero(n);  // what the lines are given: command or spool
  double command = 1.0;
  Eigen::Index next = 3;
  if (axis.valve.natural_frequency_rad_per_s > 0.0) {
    next = add_lag(out, axis.valve, next, spool, command);
    spool(next - 2) = 1.0;
    command = 0.0;
  }
  // x''' = -damping x'' - sum k_i stiffening_i x' + y_i with y_i = lag_i(K weight_i spool + k_i (stiffening_i - 1) x').
  const bool alike = axis.lines_alike();
  for (std::size_t side = 0; side < (alike ? 1u : 2u); ++side) {
    const double share = axis.gain_per_V * (alike ? 1.0 : axis.weights[side]);
    const double stiffness = alike ? axis.natural_frequency_squared() : axis.stiffness_per_s2[side];
    Eigen::RowVectorXd input = share * spool;
    input(1) += stiffness * (axis.stiffening[side] - 1.0);
    out.A(2, 1) -= stiffness * axis.stiffening[side];
    if (!(axis.lines[side].natural_frequency_rad_per_s > 0.0)) {
      out.A.row(2) += input;
      out.B(2, 0) += share * command;
      continue;
    }
    next = add_lag(out, axis.lines[side], next, input, share * command);
    out.A(2, next - 2) += 1.0;
  }
  return out;
}

StateSpace held(const StateSpace& continuous, double period_s, double delay_s) {
  const auto whole = static_cast<Eigen::Index>(std::floor(delay_s / period_s * (1.0 + 1e-12)));
  const double rest = std::max(0.0, delay_s - static_cast<double>(whole) * period_s);
  const bool split = rest > 1e-12 * period_s;
  const Eigen::Index n = continuous.A.rows(), past = whole + (split ? 1 : 0);
  const Held late = hold(continuous, period_s - rest), early = hold(continuous, rest);
  // States: those of the plant, then the inputs of the last `past` periods, the newest first.
  StateSpace out{Eigen::MatrixXd::Zero(n + past, n + past), Eigen::MatrixXd::Zero(n + past, 1),
                 Eigen::MatrixXd::Zero(continuous.C.rows(), n + past), continuous.D};
  out.A.topLeftCorner(n, n) = late.state * early.state;
  out.C.leftCols(n) = continuous.C;
  const auto feed = [&](Eigen::Index age, const Eigen::MatrixXd& by) {
    if (age == 0) out.B.topRows(n) += by;
    else out.A.block(0, n + age - 1, n, 1) += by;
  };
  feed(whole, late.input);
  if (split) feed(whole + 1, late.state * early.input);
  if (past > 0) out.B(n, 0) = 1.0;
  for (Eigen::Index i = 1; i < past; ++i) out.A(n + i, n + i - 1) = 1.0;
  return out;
}

Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& A) {
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(A.rows(), A.cols());
  return exponential_of(A, zero, static_cast<std::size_t>(A.rows()),
                        [](Eigen::MatrixXd& m, std::size_t i, std::size_t j) -> double& {
                          return m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
                        });
}

std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXd& A) {
  const Eigen::VectorXcd values = unsorted_eigenvalues(balanced(A));
  std::vector<std::complex<double>> out(values.begin(), values.end());
  sort_poles(out);
  return out;
}

}  // namespace pneuservo
