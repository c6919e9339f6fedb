// The servo table's linear plant in discrete time, and trials on it.
#include "control/linear_trial.hpp"

#include <cmath>

#include <pneuservo/control/ppd2.hpp>
#include <pneuservo/rig/axis.hpp>

namespace pneuservo {
namespace {
constexpr double after_move_s = 0.6;
}

LinearTablePlant::LinearTablePlant(const LinearServoTable& table, double period_s) noexcept
    : period_s_(period_s), length_per_V_(table.gain_per_V * period_s * period_s * period_s) {
  SquareMatrix<states + 1> a{};
  const double T = period_s;
  a[0][1] = a[1][2] = 1.0;
  a[2][1] = -table.natural_frequency_squared * T * T;
  // A lag y'' = w^2 (in - y) - 2 zeta w y'; one without frequency is passed over.
  std::size_t input = states;  // the held command, the last column
  const auto lag = [&](const SecondOrderLag& l, std::size_t at) {
    if (!(l.natural_frequency_rad_per_s > 0.0)) return;
    const double w = l.natural_frequency_rad_per_s * T;
    a[at][at + 1] = 1.0;
    a[at + 1][input] += w * w;
    a[at + 1][at] -= w * w;
    a[at + 1][at + 1] = -2.0 * l.damping_ratio * w;
    input = at;
  };
  lag(table.valve, 3);
  lag(table.line, 5);
  a[2][input] += 1.0;
  transition_ = exponential(a);
}

void LinearTablePlant::reset(double x_m) noexcept {
  state_ = {};
  state_[0] = x_m;
}

void LinearTablePlant::step(double command_V) noexcept {
  std::array<double, states> next{};
  for (std::size_t i = 0; i < states; ++i) {
    next[i] = transition_[i][states] * length_per_V_ * command_V;
    for (std::size_t j = 0; j < states; ++j) next[i] += transition_[i][j] * state_[j];
  }
  state_ = next;
}

double linear_trial_error_m(const LinearServoTable& table, const Reference& reference, double period_s,
                            const TrialController& controller) {
  LinearTablePlant plant(table, period_s);
  plant.reset(reference.at(0.0).d[0]);
  const auto last = static_cast<long>(std::floor((reference.end_s() + after_move_s) / period_s));
  double largest = 0.0;
  for (long k = 0; k <= last; ++k) {
    const double t_s = static_cast<double>(k) * period_s;
    largest = std::fmax(largest, std::fabs(reference.at(t_s).d[0] - plant.position_m()));
    plant.step(controller(t_s, plant));
  }
  return largest;
}

bool linear_loop_settles(const Ppd2Parameters& parameters, const AxisParameters<double>& axis, double period_s) {
  constexpr double start_m = 1e-6, time_s = 4.0, rest_share = 0.01;
  constexpr double rad_per_cycle = 6.283185307179586;
  Ppd2Parameters law = parameters;
  law.feedforward = FeedforwardKind::none;
  Ppd2 controller;
  controller.configure(law, axis, period_s);
  const SecondOrderLag line{rad_per_cycle * axis.line_1.natural_frequency_Hz, axis.line_1.damping_ratio};
  LinearTablePlant plant(linear_servo_table(axis, law.equilibrium_pressure_Pa, line), period_s);
  plant.reset(start_m);
  const auto ticks = std::lround(time_s / period_s);
  double late_m = 0.0;
  for (long k = 0; k < ticks; ++k) {
    plant.step(controller.step({plant.position_m(), {}, {}, {}, {}}).command_V[0]);
    if (k > ticks - ticks / 8) late_m = std::fmax(late_m, std::fabs(plant.position_m()));
  }
  return late_m < rest_share * start_m;
}

}  // namespace pneuservo
