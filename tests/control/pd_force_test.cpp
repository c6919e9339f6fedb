// PD with force feedback: the law term by term, filter, limits, anti-windup, faults, bumpless start, no allocation.
#include <catch2/catch.hpp>

#include <atomic>
#include <cstdlib>
#include <new>
#include <random>

#include <pneuservo/control/pd_force.hpp>

#include "control/reference_kinds.hpp"
#include "control/test_axis.hpp"
#include "core/test_seed.hpp"

namespace {
std::atomic<long> allocations{0};
}
void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

using namespace pneuservo;
using namespace pneuservo::test;

namespace {
ReferencePoint rest(double x_m) {
  ReferencePoint p;
  p.d[0] = x_m;
  return p;
}
constexpr double balanced_2_Pa(double p1_Pa) {
  return (1.257e-3 * p1_Pa - (1.257e-3 - 1.056e-3) * 101325.0) / 1.056e-3;
}
}  // namespace

TEST_CASE("the command is the law of the contract, term by term") {
  PdForceParameters gains = nominal_gains();
  gains.force_integral_V_per_Ns = 0.3;
  PdForce control(gains, nominal_axis(), 0.001);
  ReferencePoint r = rest(0.002);
  r.d[1] = 0.1;
  control.step(0.001, 470e3, 530e3, r, r);
  const double u = control.step(0.0013, 471e3, 529e3, r, r);
  const double a = 1.0 - std::exp(-1.0 / 3.0), v = a * 0.3;
  const double atmosphere_N = (1.257e-3 - 1.056e-3) * 101325.0;
  const double e_first = 7550.0 * 0.001 + 95.6 * 0.1 - (1.257e-3 * 470e3 - 1.056e-3 * 530e3 - atmosphere_N);
  const double f_ref = 7550.0 * 0.0007 + 95.6 * (0.1 - v), f = 1.257e-3 * 471e3 - 1.056e-3 * 529e3 - atmosphere_N;
  const double integral = 0.001 * (e_first + f_ref - f);
  const PdForceState& s = control.state();
  CHECK(s.e_m == Approx(0.0007));
  CHECK(s.v_mps == Approx(v));
  CHECK(s.F_N == Approx(f));
  CHECK(s.F_ref_N == Approx(f_ref));
  CHECK(s.e_F_N == Approx(f_ref - f));
  CHECK(s.I_Ns == Approx(integral));
  CHECK(u == Approx(0.00572 * (f_ref - f) + 0.3 * integral));
  CHECK(s.u_unlimited_V == u);
  CHECK(s.limit == limit_none);
}

TEST_CASE("the velocity filter starts at zero and answers a unit ramp as worked out apart") {
  PdForceParameters gains = nominal_gains();
  PdForce control(gains, nominal_axis(), 0.001);
  control.step(0.05, 470e3, 530e3, rest(0.05), rest(0.05));
  REQUIRE(control.state().v_mps == 0.0);
  const std::pair<int, double> known[] = {
      {1, 0.2834686894262}, {2, 0.4865828809674}, {3, 0.6321205588286}, {10, 0.9643260066527}};
  int sample = 0;
  for (const auto& [samples, v] : known) {
    for (; sample < samples; ++sample) control.step(0.05 + 0.001 * (sample + 1), 470e3, 530e3, rest(0.05), rest(0.05));
    CHECK(control.state().v_mps == Approx(v).epsilon(1e-10));
  }
  gains.velocity_filter_s = 0.0;
  control.configure(gains, nominal_axis(), 0.001);
  control.step(0.0, 470e3, 530e3, rest(0.0), rest(0.0));
  control.step(0.002, 470e3, 530e3, rest(0.0), rest(0.0));
  CHECK(control.state().v_mps == Approx(2.0));
}

TEST_CASE("the limiter holds range and rate and says which of them acted") {
  CommandLimiter range(5.0, std::numeric_limits<double>::infinity(), 0.001);
  CHECK((range.limit(7.0).command_V == 5.0 && range.limit(7.0).limit == limit_upper));
  CHECK((range.limit(-7.0).command_V == -5.0 && range.limit(-7.0).limit == limit_lower));
  CHECK((range.limit(1.25).command_V == 1.25 && range.limit(1.25).limit == limit_none));
  CommandLimiter rate(5.0, 400.0, 0.001);
  CHECK((rate.limit(7.0).command_V == Approx(0.4) && rate.limit(0.8).limit == limit_none));
  CHECK(rate.limit(7.0).limit == limit_rate_up);
  CHECK(rate.limit(-7.0).limit == limit_rate_down);
  for (int i = 0; i < 20; ++i) rate.limit(7.0);
  CHECK((rate.previous_V() == 5.0 && rate.limit(7.0).limit == limit_upper));
  rate.reset(-30.0);
  CHECK(rate.previous_V() == -5.0);
}

TEST_CASE("the integral rests only while it would push the command further into its limit") {
  PdForceParameters gains = nominal_gains();
  gains.force_integral_V_per_Ns = 2.0;
  for (const double sign : {1.0, -1.0}) {
    PdForce control(gains, symmetric_axis(), 0.001);
    const auto step = [&](double error_m) {
      return control.step(0.0, 470e3, 470e3, rest(sign * error_m), rest(sign * error_m));
    };
    step(0.3);  // 2265 N: 13 V
    const double frozen = control.state().I_Ns;
    CHECK(control.state().limit == (sign > 0 ? limit_upper : limit_lower));
    CHECK(frozen == 0.0);
    for (int i = 0; i < 100; ++i) step(0.3);
    CHECK(control.state().I_Ns == frozen);
    for (int i = 0; i < 3; ++i) step(0.05);  // inside the range it grows
    CHECK(sign * control.state().I_Ns == Approx(3 * 0.001 * 7550.0 * 0.05));
    const double grown = control.state().I_Ns;
    step(-0.3);  // limited the other way while the integral is positive: it may grow negative only if not limited so
    CHECK(control.state().limit == (sign > 0 ? limit_lower : limit_upper));
    CHECK(control.state().I_Ns == grown);
  }
  // Limited upward by a large integral while the force error is negative: the integral must come down.
  PdForce control(gains, symmetric_axis(), 0.001);
  control.start_bumpless(0.0, 470e3, 470e3, rest(0.05), rest(0.05), 5.0);
  const double before = [&] {
    control.step(0.0, 470e3, 470e3, rest(0.05), rest(0.05));
    return control.state().I_Ns;
  }();
  PdForceParameters slow = gains;
  slow.force_gain_V_per_N = 0.0;
  PdForce held(slow, symmetric_axis(), 0.001);
  held.start_bumpless(0.0, 470e3, 470e3, rest(0.0), rest(0.0), 5.0);
  for (int i = 0; i < 200; ++i) held.step(0.0, 470e3, 470e3, rest(0.01), rest(0.01));
  CHECK(held.state().limit == limit_upper);
  const double full = held.state().I_Ns;
  held.step(0.0, 470e3, 470e3, rest(-0.01), rest(-0.01));
  CHECK(held.state().I_Ns < full);
  CHECK(before > 0.0);
}

TEST_CASE("the rate limit freezes the integral upward and not downward") {
  PdForceParameters gains = nominal_gains();
  gains.force_integral_V_per_Ns = 2.0;
  gains.command_rate_V_per_s = 100.0;
  PdForce control(gains, symmetric_axis(), 0.001);
  CHECK(control.step(0.0, 470e3, 470e3, rest(0.05), rest(0.05)) == Approx(0.1));
  CHECK(control.state().limit == limit_rate_up);
  CHECK(control.state().I_Ns == 0.0);
  CHECK(control.state().u_unlimited_V == Approx(0.00572 * 7550.0 * 0.05));
}

TEST_CASE("a bumpless start gives the command it was asked for") {
  PdForceParameters gains = nominal_gains();
  gains.force_integral_V_per_Ns = 0.4;
  PdForce control(gains, nominal_axis(), 0.001);
  control.start_bumpless(0.013, 500e3, 480e3, rest(0.01), rest(0.01), 1.75);
  CHECK(control.step(0.013, 500e3, 480e3, rest(0.01), rest(0.01)) == Approx(1.75).epsilon(1e-12));
  CHECK(control.state().v_mps == 0.0);
  gains.force_integral_V_per_Ns = 0.0;
  gains.command_rate_V_per_s = 50.0;
  PdForce by_rate(gains, nominal_axis(), 0.001);
  by_rate.start_bumpless(0.013, 500e3, 480e3, rest(0.01), rest(0.01), 1.75);
  CHECK(std::fabs(by_rate.step(0.013, 500e3, 480e3, rest(0.01), rest(0.01)) - 1.75) <= 0.05 + 1e-12);
}

TEST_CASE("a command that is not finite is a fault, keeps the last output, and leaves no trace in the state") {
  PdForceParameters gains = nominal_gains();
  gains.force_integral_V_per_Ns = 0.4;
  gains.flow_feedforward = FeedforwardSource::formula;
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const auto& [x, p1, p2] : {std::array{nan, 470e3, 530e3}, std::array{0.0, nan, 530e3},
                                  std::array{0.0, 470e3, inf}, std::array{inf, 470e3, 530e3}}) {
    PdForce control(gains, nominal_axis(), 0.001);
    control.step(0.0, 470e3, 530e3, rest(0.001), rest(0.001));
    const double last = control.step(0.0001, 470e3, 530e3, rest(0.001), rest(0.001));
    const PdForceState before = control.state();
    CHECK(control.step(x, p1, p2, rest(0.001), rest(0.001)) == last);
    CHECK(control.state().fault == controller_command_not_finite);
    CHECK(control.state().I_Ns == before.I_Ns);
    CHECK(control.state().v_mps == before.v_mps);
    // The sample after the gap: the difference counts over two periods.
    CHECK(std::isfinite(control.step(0.0003, 470e3, 530e3, rest(0.001), rest(0.001))));
    CHECK(control.state().fault == controller_healthy);
    const double a = -std::expm1(-1.0 / 3.0);
    CHECK(control.state().v_mps == Approx(before.v_mps + a * (0.1 - before.v_mps)));
  }
}

TEST_CASE("mirrored motion of a symmetric axis gives the opposite command") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  PdForceParameters gains = nominal_gains();
  gains.force_integral_V_per_Ns = 0.5;
  gains.flow_feedforward = FeedforwardSource::formula;
  gains.command_rate_V_per_s = 800.0;
  PdForce one(gains, symmetric_axis(), 0.001), other(gains, symmetric_axis(), 0.001);
  for (int i = 0; i < 500; ++i) {
    ReferencePoint r, mirrored;
    const double scale[4] = {0.1, 0.5, 3.0, 30.0};
    for (std::size_t k = 0; k < 4; ++k) mirrored.d[k] = -(r.d[k] = scale[k] * unit(random));
    const double x = r.d[0] + 0.01 * unit(random), p1 = 450e3 + 1e5 * unit(random), p2 = 450e3 + 1e5 * unit(random);
    REQUIRE(one.step(x, p1, p2, r, r) ==
            Approx(-other.step(-x, p2, p1, mirrored, mirrored)).epsilon(1e-12).margin(1e-13));
  }
}

TEST_CASE("at rest in balance nothing is commanded, with and without feedforward") {
  PdForceParameters gains = nominal_gains();
  for (const FeedforwardSource feedforward : {FeedforwardSource::off, FeedforwardSource::formula}) {
    gains.flow_feedforward = feedforward;
    PdForce control(gains, nominal_axis(), 0.001);
    CHECK(std::fabs(control.step(0.02, 470e3, balanced_2_Pa(470e3), rest(0.02), rest(0.02))) < 1e-12);
  }
}

namespace {

/// A pass along a sine whose measurements have no meaning beside each other, with the axis' supply.
LawSetup pass_setup(const AxisParameters<double>& axis, const Reference& reference, double supply_Pa) {
  auto table = std::make_shared<PassTable>();
  for (int i = 0; i < 400; ++i) {
    const double t = 1e-3 * i;
    table->rows.push_back({std::sin(9.0 * t), reference.at(t).d[0], 470e3 + 5e4 * std::sin(3.0 * t),
                           530e3 - 4e4 * std::sin(4.0 * t), supply_Pa});
  }
  return {axis, 1e-3, reference, 0.4, table};
}

ReferenceSpec sine_60mm() {
  ReferenceSpec spec;
  spec.amplitude_m = 0.06;
  spec.frequency_Hz = 2.0;
  spec.ramp_s = 0.2;
  spec.smoothness = 7;
  return spec;
}

}  // namespace

TEST_CASE("where everything shows as in the pass the command is that of the pass") {
  PdForceParameters gains = nominal_gains();
  gains.flow_feedforward = FeedforwardSource::pass;
  gains.feedforward_lead_s = 0.007;
  const AxisParameters<double> axis = nominal_axis();
  const Reference reference(sine_60mm());
  const LawSetup setup = pass_setup(axis, reference, 690e3);
  PdForce control;
  control.configure(gains, setup);
  ControlInput in;
  for (in.tick = 0; in.tick < 400; ++in.tick) {
    const double t = 1e-3 * static_cast<double>(in.tick);
    const PassRow& row = setup.pass->rows[static_cast<std::size_t>(in.tick)];
    in.now = reference.at(t), in.ahead = reference.at(t + control.lead_s());
    in.x_m = row.x_m, in.pressure_Pa = {row.p1_Pa, row.p2_Pa}, in.supply_Pa = row.supply_Pa;
    REQUIRE(control.step(in).command_V[0] == Approx(row.asked_V).margin(1e-9));
    REQUIRE(control.state().u_pass_V == row.asked_V);
  }
}

TEST_CASE("what differs from the pass is commanded by the formula and the force loop") {
  PdForceParameters gains = nominal_gains();
  gains.flow_feedforward = FeedforwardSource::pass;
  const AxisParameters<double> axis = nominal_axis();
  const Reference reference(sine_60mm());
  const LawSetup setup = pass_setup(axis, reference, 700e3);
  PdForce control;
  control.configure(gains, setup);
  const FlowFeedforward formula(axis);
  ControlInput in;
  in.tick = 300;
  in.now = in.ahead = reference.at(0.3);
  const PassRow& row = setup.pass->rows[300];
  in.x_m = row.x_m, in.pressure_Pa = {row.p1_Pa + 2e4, row.p2_Pa - 1e4}, in.supply_Pa = 650e3;
  control.step(in);
  const double differs_V = formula.command_V(in.ahead, in.pressure_Pa[0], in.pressure_Pa[1], 650e3) -
                           formula.command_V(in.ahead, row.p1_Pa, row.p2_Pa, 700e3);
  CHECK(control.state().u_feedforward_V == Approx(row.asked_V + differs_V).margin(1e-12));
  // Less supply needs a wider valve, and a missing sensor leaves the axis' own.
  CHECK(formula.command_V(in.ahead, row.p1_Pa, row.p2_Pa, 650e3) !=
        formula.command_V(in.ahead, row.p1_Pa, row.p2_Pa, 700e3));
  CHECK(formula.command_V(in.ahead, row.p1_Pa, row.p2_Pa, std::nan("")) ==
        formula.command_V(in.ahead, row.p1_Pa, row.p2_Pa, 700e3));
}

TEST_CASE("before its first and after its last tick a pass rests, and without one it is refused") {
  PdForceParameters gains = nominal_gains();
  gains.flow_feedforward = FeedforwardSource::pass;
  const AxisParameters<double> axis = nominal_axis();
  const Reference reference(sine_60mm());
  LawSetup setup = pass_setup(axis, reference, 700e3);
  PdForce control;
  control.configure(gains, setup);
  ControlInput in;
  in.pressure_Pa = {470e3, 530e3};
  for (const std::int64_t tick : {-100000, -1, 0}) {
    in.tick = tick;
    control.step(in);
    CHECK(control.state().u_pass_V == setup.pass->rows.front().asked_V);
  }
  in.tick = 1'000'000;
  control.step(in);
  CHECK(control.state().u_pass_V == setup.pass->rows.back().asked_V);
  setup.pass = nullptr;
  CHECK_THROWS_AS(control.configure(gains, setup), std::invalid_argument);
}

TEST_CASE("the command path allocates nothing") {
  PdForceParameters gains = nominal_gains();
  gains.flow_feedforward = FeedforwardSource::formula;
  gains.feedforward_lead_s = 0.01;
  PdForce control(gains, nominal_axis(), 0.001);
  for (const NamedReference& named : all_references()) {
    const Reference r(named.spec, load_samples);
    const long before = allocations;
    double sum = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double t = 0.001 * i;
      sum += control.step(0.0, 470e3, 530e3, r.at(t), r.at(t + control.lead_s()));
    }
    REQUIRE(allocations == before);
    REQUIRE(std::isfinite(sum));
  }
  gains.flow_feedforward = FeedforwardSource::pass;
  const AxisParameters<double> axis = nominal_axis();
  const Reference reference(sine_60mm());
  control.configure(gains, pass_setup(axis, reference, 700e3));
  const long before = allocations;
  ControlInput in;
  in.pressure_Pa = {470e3, 530e3};
  for (in.tick = -10; in.tick < 500; ++in.tick) control.step(in);
  REQUIRE(allocations == before);
}
