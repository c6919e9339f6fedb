// A control loop as its sampled law and its held plant: closed-loop poles, margins, step response.
#include "design/sampled_loop.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace pneuservo {

namespace {

using Complex = std::complex<double>;
constexpr double pole_of_the_plant = 1e4;  // |L| above this: an undamped plant resonance, not a crossing
constexpr double lowest_Hz = 0.01;
constexpr int points = 6000;

/// Frequency between two at which `crosses` changes its sign.
template <class Function> double crossing(const Function& crosses, double low, double high) {
  const bool sign = crosses(low) > 0.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    ((crosses(middle) > 0.0) == sign ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

}  // namespace

Eigen::MatrixXd SampledLoop::closed(double gain) const {
  const Eigen::Index n = plant.A.rows(), m = law.A.rows(), y = plant.C.rows();
  Eigen::MatrixXd out(n + m, n + m);
  out.topLeftCorner(n, n) = plant.A + gain * plant.B * law.D.leftCols(y) * plant.C;
  out.topRightCorner(n, m) = gain * plant.B * law.C;
  out.bottomLeftCorner(m, n) = law.B.leftCols(y) * plant.C;
  out.bottomRightCorner(m, m) = law.A;
  return out;
}

std::vector<Complex> SampledLoop::poles(double gain) const {
  std::vector<Complex> out;
  for (const Complex z : eigenvalues(closed(gain)))
    if (std::abs(z) > 1e-6) out.push_back(std::log(z) / period_s);
  sort_poles(out);
  return out;
}

Complex SampledLoop::open(double frequency_Hz) const {
  const Complex z = std::exp(Complex(0.0, 2.0 * std::numbers::pi * frequency_Hz * period_s));
  return -(law.transfer(z).leftCols(plant.C.rows()) * plant.transfer(z))(0, 0);
}

LoopMargins margins_of(const std::function<Complex(double)>& open, double highest_Hz) {
  LoopMargins out;
  out.gain_up = std::numeric_limits<double>::infinity();
  out.phase_deg = std::numeric_limits<double>::quiet_NaN();
  const double ratio = std::pow(highest_Hz / lowest_Hz, 1.0 / points);
  double low = lowest_Hz;
  Complex before = open(low);
  for (int i = 1; i < points; ++i) {
    const double high = low * ratio;
    const Complex here = open(high);
    if ((before.imag() > 0.0) != (here.imag() > 0.0) && before.real() < 0.0 && here.real() < 0.0) {
      const double f = crossing([&](double Hz) { return open(Hz).imag(); }, low, high);
      const Complex at = open(f);
      const double gain = 1.0 / std::abs(at);
      if (at.real() < 0.0 && gain * pole_of_the_plant > 1.0) {
        if (gain > 1.0 && gain < out.gain_up) out.gain_up = gain, out.gain_up_Hz = f;
        if (gain < 1.0 && gain > out.gain_down) out.gain_down = gain, out.gain_down_Hz = f;
      }
    }
    if ((std::abs(before) > 1.0) != (std::abs(here) > 1.0)) {
      const double f = crossing([&](double Hz) { return std::abs(open(Hz)) - 1.0; }, low, high);
      const double phase = std::fabs(std::arg(-open(f))) * 180.0 / std::numbers::pi;
      if (!(phase >= out.phase_deg)) out.phase_deg = phase, out.phase_Hz = f;
    }
    low = high;
    before = here;
  }
  return out;
}

// 1 + L turns by +90 deg, from -90 deg at the integrator to a real number above 0 at half the sampling rate.
// Samples one per cent apart: a resonance of damping 0.02 is four of them wide.
NyquistVerdict nyquist_verdict(const std::function<Complex(double)>& open, double highest_Hz) {
  constexpr double ratio = 1.01;
  Complex before = 1.0 + open(lowest_Hz);
  double angle = std::arg(before), nearest = std::abs(before), f = lowest_Hz;
  NyquistVerdict out{false, lowest_Hz};
  for (f *= ratio; f < highest_Hz; f *= ratio) {
    const Complex here = 1.0 + open(f);
    angle += std::arg(here / before);
    before = here;
    if (std::abs(here) < nearest) nearest = std::abs(here), out.nearest_Hz = f;
  }
  out.is_stable = std::fabs(angle) < 0.5 * std::numbers::pi;
  return out;
}

StepResponse step_response(const SampledLoop& loop, double duration_s) {
  const Eigen::Index n = loop.plant.A.rows(), m = loop.law.A.rows(), y = loop.plant.C.rows();
  const Eigen::MatrixXd transition = loop.closed();
  Eigen::VectorXd input(n + m), state = Eigen::VectorXd::Zero(n + m);
  input.head(n) = loop.plant.B * loop.law.D.col(y);
  input.tail(m) = loop.law.B.col(y);
  StepResponse out;
  for (int k = 0; k * loop.period_s <= duration_s; ++k) {
    out.t_s.push_back(k * loop.period_s);
    out.y.push_back(loop.plant.C.row(0).dot(state.head(n)));
    state = transition * state + input;
  }
  out.settling_s = std::numeric_limits<double>::quiet_NaN();
  std::size_t settled = out.y.size();
  for (std::size_t i = out.y.size(); i-- > 0;) {
    out.overshoot = std::max(out.overshoot, out.y[i] - 1.0);
    if (settled == i + 1 && std::fabs(out.y[i] - 1.0) <= 0.02) settled = i;
  }
  if (settled < out.y.size()) out.settling_s = out.t_s[settled];
  return out;
}

}  // namespace pneuservo
