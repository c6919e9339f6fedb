// The integral of time times absolute error of a step response, and the coefficients that make it least.
#include "design/itae.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/LU>

#include "design/nelder_mead.hpp"
#include "design/state_space.hpp"

namespace pneuservo {

namespace {

constexpr double time_step = 0.05;  // in units of the mean time constant: many in the fastest oscillation that counts
constexpr int time_steps_max = 40000;
constexpr double settled = 1e-10;

/// Error of the step in normalised time: e(t) = row exp(A t) start.
struct ErrorSystem {
  Eigen::MatrixXd A;
  Eigen::RowVectorXd row;
  Eigen::VectorXd start;
};

/// Controllable canonical form in time times scale (1/s), moved so that its rest is the settled state.
ErrorSystem error_system(const Polynomial& numerator, const Polynomial& denominator, double scale) {
  const auto n = static_cast<Eigen::Index>(denominator.size()) - 1;
  const auto coefficient = [&](const Polynomial& p, Eigen::Index i) {
    return static_cast<std::size_t>(i) < p.size() ? p[static_cast<std::size_t>(i)] * std::pow(scale, i) : 0.0;
  };
  const double leading = coefficient(denominator, n);
  ErrorSystem out{Eigen::MatrixXd::Zero(n, n), Eigen::RowVectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i + 1 < n) out.A(i, i + 1) = 1.0;
    out.A(n - 1, i) = -coefficient(denominator, i) / leading;
    out.row(i) = coefficient(numerator, i) / leading;
  }
  out.start(0) = leading / coefficient(denominator, 0);
  return out;
}

/// Time within (0, step) after `state` at which the error is zero, by Newton on its Taylor series kept between bounds.
double zero_within(const ErrorSystem& e, const Eigen::VectorXd& state) {
  double low = 0.0, high = time_step, t = 0.5 * time_step;
  const bool positive = e.row.dot(state) > 0.0;
  const auto at = [&](double time, double& slope) {
    Eigen::VectorXd term = state, rate = e.A * state;
    double value = e.row.dot(state);
    slope = e.row.dot(rate);
    for (int k = 1; k <= 14; ++k) {
      term = e.A * term * (time / k);
      value += e.row.dot(term);
      slope += e.row.dot(e.A * term);
    }
    return value;
  };
  for (int i = 0; i < 60; ++i) {
    double slope = 0.0;
    const double value = at(t, slope);
    ((value > 0.0) == positive ? low : high) = t;
    const double next = t - value / slope;
    const double moved = next > low && next < high ? next : 0.5 * (low + high);
    if (std::fabs(moved - t) < 1e-15) break;
    t = moved;
  }
  return t;
}

double integrate(const ErrorSystem& e) {
  const Eigen::MatrixXd transition = matrix_exponential(e.A * time_step);
  // The integral of t row exp(A t) x is row (t A^-1 - A^-2) exp(A t) x.
  const Eigen::MatrixXd inverse = e.A.inverse();
  const Eigen::RowVectorXd once = e.row * inverse, twice = once * inverse;
  const auto antiderivative = [&](double t, const Eigen::VectorXd& x) { return t * once.dot(x) - twice.dot(x); };
  Eigen::VectorXd x = e.start;
  double sum = 0.0, from = antiderivative(0.0, x);
  const double size = x.norm();
  for (int i = 0; i < time_steps_max; ++i) {
    const Eigen::VectorXd next = transition * x;
    const double here = e.row.dot(x), there = e.row.dot(next);
    if ((here > 0.0) != (there > 0.0) && here != 0.0) {
      const double inside = zero_within(e, x), t = i * time_step + inside;
      const double to = antiderivative(t, matrix_exponential(e.A * inside) * x);
      sum += std::fabs(to - from);
      from = to;
    }
    x = next;
    if (!(x.norm() < 1e6 * size)) return std::numeric_limits<double>::infinity();
    if (x.norm() < settled * size) return sum + std::fabs(from);  // the antiderivative ends at 0
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

double itae_of_step(const Polynomial& numerator, const Polynomial& denominator) {
  const double scale =
      std::pow(denominator.front() / denominator.back(), 1.0 / static_cast<double>(denominator.size() - 1));
  if (!(scale > 0.0)) return std::numeric_limits<double>::infinity();
  return integrate(error_system(numerator, denominator, scale)) / (scale * scale);
}

NormalisedCoefficients classic_itae_coefficients(int order) {
  switch (order) {
    case 3: return {2.15, 1.75};
    case 4: return {2.7, 3.4, 2.1};
    case 5: return {3.4, 5.5, 5.0, 2.8};
    case 6: return {3.95, 7.45, 8.60, 6.60, 3.25};
    case 7: return {4.58, 10.64, 15.54, 15.08, 10.42, 4.475};
    default: throw std::invalid_argument("ITAE coefficients are there for the orders 3 to 7");
  }
}

double itae_of_coefficients(const NormalisedCoefficients& coefficients) {
  Polynomial denominator{1.0};
  denominator.insert(denominator.end(), coefficients.begin(), coefficients.end());
  denominator.push_back(1.0);
  return itae_of_step({1.0}, denominator);
}

NormalisedCoefficients least_itae_coefficients(int order) {
  return nelder_mead([](const std::vector<double>& c) { return itae_of_coefficients(c); },
                     classic_itae_coefficients(order))
      .at;
}

}  // namespace pneuservo
