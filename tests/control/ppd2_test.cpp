// PPD2: the law term by term, integral and limits, changes of gains, late and bad samples.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <random>

#include <pneuservo/control/ppd2.hpp>

#include "control/table_axis.hpp"
#include "core/test_seed.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {
constexpr double ppd2_period_s = 2e-4;

AxisParameters<double> axis_4mm() {
  AxisParameters<double> axis = table_axis(table_4mm);
  axis.line_1.natural_frequency_Hz = 110.0;
  axis.line_1.damping_ratio = 0.068;
  return axis;
}

Ppd2Parameters nominal() {
  Ppd2Parameters p;
  p.position_gain_V_per_m = 1200.0;
  p.velocity_gain_Vs_per_m = 54.0;
  p.acceleration_gain_Vs2_per_m = 1.3;
  p.feedforward = FeedforwardKind::order_5;
  return p;
}

Ppd2 controller_of(const Ppd2Parameters& p) {
  Ppd2 controller;
  controller.configure(p, axis_4mm(), ppd2_period_s);
  return controller;
}

ReferencePoint at_rest(double x_m) {
  ReferencePoint r;
  r.d[0] = x_m;
  return r;
}
ControlInput at(double x_m, const ReferencePoint& r) { return {x_m, {}, {}, {}, r, r}; }
}  // namespace

TEST_CASE("ppd2 on the error: feedforward ahead, feedback of the observer's three states") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Ppd2Parameters p = nominal();
  Ppd2 controller = controller_of(p);
  MotionObserver observer;
  observer.configure(ObserverGains::butterworth(1000.0), ppd2_period_s);
  const auto c = feedforward_coefficients(linear_servo_table(axis_4mm(), 110e3, table_4mm.line), {1200, 54, 1.3}, 5);
  for (int k = 0; k < 50; ++k) {
    ReferencePoint now, ahead;
    for (std::size_t i = 0; i < 8; ++i) {
      now.d[i] = 1e-3 * unit(random);
      ahead.d[i] = 1e-3 * unit(random);
    }
    const double x = now.d[0] + 1e-9 * unit(random);
    observer.step(x - now.d[0]);
    double r = 0.0;
    for (std::size_t i = 0; i < 8; ++i) r += c[i] * ahead.d[i];
    const double u = 1200.0 * (r - ahead.d[0]) - 54.0 * ahead.d[1] - 1.3 * ahead.d[2] - 1200.0 * observer.position_m() -
                     54.0 * observer.velocity_mps() - 1.3 * observer.acceleration_mps2();
    const auto command = controller.step({x, {}, {}, {}, now, ahead}).command_V;
    CHECK(command[0] == Approx(u).epsilon(1e-9).margin(1e-12));
    CHECK(command[1] == -command[0]);
    CHECK(controller.state().speed_mps == Approx(observer.velocity_mps() + now.d[1]));
  }
  CHECK(controller.lead_s() == Approx(1e-4));
}

TEST_CASE("ppd2 on the measured position: r - x_measured, velocity and acceleration of the observer") {
  Ppd2Parameters p = nominal();
  p.observer = ObserverInput::measured;
  p.observer_gains = {530.5, 140739.9, 1.85e7};
  p.command_delay_s = 1e-4;
  Ppd2 controller = controller_of(p);
  CHECK(controller.lead_s() == 0.0);
  MotionObserver observer;
  observer.configure({530.5, 140739.9, 1.85e7}, ppd2_period_s);
  const auto c = feedforward_coefficients(linear_servo_table(axis_4mm(), 110e3, table_4mm.line), {1200, 54, 1.3}, 5);
  for (int k = 0; k < 50; ++k) {
    ReferencePoint now;
    for (std::size_t i = 0; i < 8; ++i) now.d[i] = 1e-3 * std::sin(k + 2.0 * static_cast<double>(i));
    const double x = now.d[0] + 1e-7 * std::sin(3.0 * k);
    observer.step(x);
    double r = 0.0;
    for (std::size_t i = 0; i < 8; ++i) r += c[i] * now.d[i];
    const double u = 1200.0 * (r - x) - 54.0 * observer.velocity_mps() - 1.3 * observer.acceleration_mps2();
    const double limited = std::clamp(u, -1.6, 1.6);
    CHECK(controller.step({x, {}, {}, {}, now, now}).command_V[0] == Approx(limited).epsilon(1e-9).margin(1e-12));
  }
}

TEST_CASE("without feedforward both laws follow x_ref alone") {
  // At rest at the reference, which has speed and acceleration of its own: only the law on the error sees them.
  Ppd2Parameters p = nominal();
  p.feedforward = FeedforwardKind::none;
  ReferencePoint r = at_rest(0.01);
  r.d[1] = 1e-3, r.d[2] = 1e-2, r.d[3] = 5.0;
  Ppd2 on_error = controller_of(p);
  CHECK(on_error.step({0.01, {}, {}, {}, r, r}).command_V[0] == Approx(-54.0 * 1e-3 - 1.3 * 1e-2));
  p.observer = ObserverInput::measured;
  Ppd2 measured = controller_of(p);
  CHECK(measured.step({0.01, {}, {}, {}, r, r}).command_V[0] == 0.0);
}

TEST_CASE("delay and hold are looked ahead for") {
  Ppd2Parameters p = nominal();
  p.command_delay_s = 3e-4;
  CHECK(controller_of(p).lead_s() == Approx(4e-4));
}

TEST_CASE("the integral sums the error and stands while a command is limited, and the limits say which acted") {
  Ppd2Parameters p = nominal();
  p.integral_gain_V_per_m_s = 1e4;
  Ppd2 controller = controller_of(p);
  const double e = 1e-6;
  for (int k = 0; k < 1000; ++k) controller.step(at(0.01 + e, at_rest(0.01)));
  CHECK(controller.state().I_ms == Approx(-e * 1000 * ppd2_period_s));
  CHECK(controller.state().u_V[0] == Approx(-1200.0 * e - 1e4 * e * 0.2).epsilon(1e-6));
  CHECK(controller.state().limit[0] == limit_none);

  // The integral learns of a limit from the tick before.
  controller.step(at(0.01 - 0.01, at_rest(0.01)));
  const double before = controller.state().I_ms;
  for (int k = 0; k < 10; ++k) controller.step(at(0.01 - 0.01, at_rest(0.01)));
  CHECK(controller.state().limit[0] == limit_upper);
  CHECK(controller.state().limit[1] == limit_lower);
  CHECK(controller.state().u_V[0] == 1.6);
  CHECK(controller.state().u_V[1] == -1.6);
  CHECK(controller.state().I_ms == before);

  p.command_rate_V_per_s = 100.0;  // 0.02 V a period
  Ppd2 slow = controller_of(p);
  slow.step(at(0.01, at_rest(0.01)));
  slow.step(at(0.0, at_rest(0.01)));
  CHECK(slow.state().u_V[0] == Approx(0.02));
  CHECK(slow.state().limit[0] == limit_rate_up);
  CHECK(slow.state().limit[1] == limit_rate_down);
  const double standing = slow.state().I_ms;
  slow.step(at(0.0, at_rest(0.01)));
  CHECK(slow.state().I_ms == standing);
}

TEST_CASE("rates count from the commands before the start") {
  Ppd2Parameters p = nominal();
  p.command_rate_V_per_s = 100.0;
  Ppd2 controller = controller_of(p);
  controller.reset({0.5, -0.4});
  const auto u = controller.step(at(0.01, at_rest(0.01))).command_V;
  CHECK(u[0] == Approx(0.48));
  CHECK(u[1] == Approx(-0.38));
}

TEST_CASE("other gains come without a jump: into the integral, or fading") {
  for (const double integral : {0.0, 1e4}) {
    INFO("integral gain " << integral);
    Ppd2Parameters p = nominal();
    p.integral_gain_V_per_m_s = integral;
    Ppd2 controller = controller_of(p), untouched = controller_of(p);
    const auto x = [](int k) { return 0.01 + 1e-6 * std::sin(0.01 * k); };
    for (int k = 0; k < 500; ++k) {
      controller.step(at(x(k), at_rest(0.01)));
      untouched.step(at(x(k), at_rest(0.01)));
    }
    Ppd2GainSet gains = controller.gains();
    gains.position_gain_V_per_m = 2400.0;
    controller.change_gains(gains);
    const double changed = controller.step(at(x(500), at_rest(0.01))).command_V[0];
    const double before = untouched.step(at(x(500), at_rest(0.01))).command_V[0];
    CHECK(std::fabs(changed - before) < 1e-12);
    CHECK(controller.gains() == gains);
    // Afterwards the new gain acts, and without an integral the trace of the change is gone after a second.
    for (int k = 0; k < 10000; ++k) controller.step(at(0.01 + 1e-6, at_rest(0.01)));
    if (integral == 0.0) CHECK(controller.state().u_V[0] == Approx(-2400e-6).epsilon(1e-3));
  }
}

TEST_CASE("a bad sample keeps commands and state, late samples count over their time") {
  Ppd2 controller = controller_of(nominal()), twin = controller_of(nominal());
  const auto x = [](int k) { return 0.01 + 1e-7 * k; };
  for (int k = 0; k < 20; ++k) {
    controller.step(at(x(k), at_rest(0.01)));
    twin.step(at(x(k), at_rest(0.01)));
  }
  const double last = controller.state().u_V[0];
  CHECK(controller.step(at(std::numeric_limits<double>::quiet_NaN(), at_rest(0.01))).command_V[0] == last);
  CHECK_FALSE(controller.state().finite);
  twin.step(at(x(20), at_rest(0.01)));
  // Samples on a line: one missing changes nothing.
  controller.step(at(x(21), at_rest(0.01)));
  twin.step(at(x(21), at_rest(0.01)));
  CHECK(controller.state().v_mps == Approx(twin.state().v_mps).epsilon(1e-9));
  CHECK(controller.state().finite);
  controller.skip(3);
  for (int k = 22; k <= 25; ++k) twin.step(at(x(k), at_rest(0.01)));
  controller.step(at(x(25), at_rest(0.01)));
  CHECK(controller.state().a_mps2 == Approx(twin.state().a_mps2).epsilon(1e-6));
}
