// Valve: edge areas, dead band, offset, hysteresis loop, lag, dead time, spool dynamics against closed forms.
#include <vector>

#include <catch2/catch.hpp>

#include <pneuservo/elements/valves.hpp>

using namespace pneuservo;

namespace {
ValveParameters<double> valve_parameters(double frequency_Hz = 0.0, double damping = 0.7) {
  return {5.0, 2.6e-6, 1.3e-5, 0.35, frequency_Hz, damping};
}
Valve<double> make_valve(const ValveEffects<double>& effects = {}, double step_s = 1e-3,
                         const ValveParameters<double>& p = valve_parameters()) {
  Valve<double> valve;
  valve.configure(p, effects, 1e-3);
  valve.set_time_step(step_s);
  return valve;
}
double spool_after(Valve<double>& valve, double command) {
  valve.set_command(command);
  valve.step(0.0);
  return valve.spool();
}
/// Of both ports, with the spool at rest under this command.
PortAreas<Pair<double>> five_port_areas(const ValveEffects<double>& effects, double command_V) {
  ValveParameters<double> parameters;
  parameters = {5.0, 2.6e-6, 1.3e-5, 0.35};
  Valves<double> valves;
  valves.configure(ValveArrangement::five_port, parameters, effects, 1e-3);
  valves.reset(command_V);
  valves.set_commands(command_V, 0.0);
  valves.set_time_step(1e-3);
  return valves.step(0.0);
}

}  // namespace

TEST_CASE("valve: a positive spool feeds the port, a negative one exhausts it, at most area_max") {
  const Valve<double> valve = make_valve();
  for (const double s : {0.1, 1.0, 4.9, 7.0}) {
    const double area = std::min(2.6e-6 * s, 1.3e-5);
    const PortAreas<double> forward = valve.areas(s), backward = valve.areas(-s);
    CHECK((forward.supply == Approx(area) && forward.exhaust == 0.0));
    CHECK((backward.supply == 0.0 && backward.exhaust == Approx(area)));
  }
  const PortAreas<double> shut = valve.areas(0.0);
  CHECK((shut.supply == 0.0 && shut.exhaust == 0.0));
}

TEST_CASE("valves: a five-port spool feeds one port and exhausts the other, a pair of valves obeys two commands") {
  ValveEffects<double> effects;
  effects.valve_offset.offset_V = 0.1;
  effects.valve_asymmetry.exhaust_ratio = 1.1;
  Valves<double> valves;
  const auto areas_at = [&](ValveArrangement arrangement, double u_1, double u_2) {
    valves.configure(arrangement, valve_parameters(), effects, 1e-3);
    valves.set_time_step(1e-3);
    valves.set_commands(u_1, u_2);
    return valves.step(0.0);
  };
  const double k = 2.6e-6;
  const auto one = areas_at(ValveArrangement::five_port, 1.0, 0.7);  // 0.7 reaches nothing
  CHECK((low(one.supply) == Approx(1.1 * k) && low(one.exhaust) == 0.0));
  CHECK((high(one.supply) == 0.0 && high(one.exhaust) == Approx(1.1 * 1.1 * k)));
  const auto back = areas_at(ValveArrangement::five_port, -1.0, 0.0);
  CHECK((low(back.supply) == 0.0 && low(back.exhaust) == Approx(1.1 * 0.9 * k)));
  CHECK((high(back.supply) == Approx(0.9 * k) && high(back.exhaust) == 0.0));
  const auto two = areas_at(ValveArrangement::three_port_pair, 1.0, 0.5);
  CHECK((low(two.supply) == Approx(1.1 * k) && high(two.supply) == Approx(0.6 * k)));
  CHECK((low(two.exhaust) == 0.0 && high(two.exhaust) == 0.0));
}

TEST_CASE("valve: dead band, offset, neutral leak and asymmetry") {
  ValveEffects<double> effects;
  effects.valve_dead_band.width_V = 0.2;
  effects.valve_offset.offset_V = 0.1;
  effects.valve_neutral_leak.area_m2 = 1e-9;
  effects.valve_asymmetry.exhaust_ratio = 1.1;
  const Valve<double> valve = make_valve(effects);
  CHECK(valve.areas(0.05).supply == Approx(1e-9));
  CHECK(valve.areas(0.05).exhaust == Approx(1e-9));
  CHECK(valve.areas(1.1).supply == Approx(1e-9 + 2.6e-6 * 1.0));          // |1.1 + 0.1| - 0.2
  CHECK(valve.areas(-1.1).exhaust == Approx(1e-9 + 1.1 * 2.6e-6 * 0.8));  // |-1.1 + 0.1| - 0.2
}

TEST_CASE("valve: a curve changes the slope about the middle and wide open, of both edges alike") {
  ValveEffects<double> effects;
  effects.valve_curve = {0.2, -0.1};
  const Valve<double> valve = make_valve(effects);
  const double slope = 2.6e-6;  // s_max is 5 V, the bend lies at 0.5 V
  CHECK(valve.areas(1e-6).supply == Approx(1e-6 * slope * 1.2).epsilon(1e-5));
  CHECK(valve.areas(0.5).supply == Approx(0.5 * slope * (1 + 0.2 / 2 - 0.1 * 0.1)));
  CHECK(valve.areas(-2.0).exhaust == Approx(2.0 * slope * (1 + 0.2 * 0.2 - 0.1 * 0.4)));
  CHECK(valve.areas(-2.0).supply == 0.0);
  effects.valve_curve = {-0.9, -0.9};
  CHECK(make_valve(effects).areas(4.9).supply >= 0.0);  // a slope may vanish, an area not turn its sign
}

TEST_CASE("valve: edges beside a straight line, each way of the spool by itself, at both ports of a pair") {
  ValveEffects<double> effects;
  effects.valve_linearity_forward = {0.1, 0.2, 0.2, 0.1, -0.1, 0.05};
  effects.valve_linearity_backward.at_8_percent = 0.3;
  const auto slope_at = [&](double command_V) {
    const PortAreas<Pair<double>> areas = five_port_areas(effects, command_V);
    CHECK((command_V > 0 ? low(areas.exhaust) : low(areas.supply)) == 0.0);
    const double one = command_V > 0 ? low(areas.supply) : low(areas.exhaust),
                 other = command_V > 0 ? high(areas.exhaust) : high(areas.supply);
    CHECK(one == other);  // one spool
    return one / std::abs(command_V) / 2.6e-6;
  };
  CHECK(slope_at(0.05) == Approx(1.1));  // below the first way
  CHECK(slope_at(0.1) == Approx(1.1));
  CHECK(slope_at(0.2) == Approx(1.15));  // half way from 3 to 5 %
  CHECK(slope_at(0.4) == Approx(1.2));
  CHECK(slope_at(0.6) == Approx(1.1));
  CHECK(slope_at(0.8) == Approx(1.0));
  CHECK(slope_at(1.0) == Approx(0.9));
  CHECK(slope_at(1.5) == Approx(0.975));
  CHECK(slope_at(4.0) == Approx(1.05));  // beyond the last way
  CHECK(slope_at(-0.25) == Approx(1.0));
  CHECK(slope_at(-0.325) == Approx(1.15));
  CHECK(slope_at(-0.4) == Approx(1.3));
  CHECK(slope_at(-0.6) == Approx(1.0));
}

TEST_CASE("valve: each of the four edges of a five-port spool has its own slope and overlap") {
  ValveEffects<double> effects;
  effects.valve_dead_band.width_V = 0.2;
  effects.valve_edge_slopes = {.supply_1 = 0.1, .exhaust_1 = -0.1, .supply_2 = 0.2, .exhaust_2 = -0.2};
  effects.valve_edge_overlaps = {.supply_1 = 0.05, .exhaust_1 = 0.1, .supply_2 = -0.15, .exhaust_2 = 0.2};
  const PortAreas<Pair<double>> forward = five_port_areas(effects, 1.0), backward = five_port_areas(effects, -1.0);
  CHECK(low(forward.supply) == Approx(1.1 * 2.6e-6 * (1.0 - 0.21)));
  CHECK(high(forward.exhaust) == Approx(0.8 * 2.6e-6 * (1.0 - 0.24)));
  CHECK(high(backward.supply) == Approx(1.2 * 2.6e-6 * (1.0 - 0.17)));
  CHECK(low(backward.exhaust) == Approx(0.9 * 2.6e-6 * (1.0 - 0.22)));
  CHECK((low(forward.exhaust) == 0.0 && high(forward.supply) == 0.0));
}

TEST_CASE("valve: a spool that sticks stays until the command is far enough away, and then is where it is") {
  ValveEffects<double> effects;
  effects.valve_stiction.threshold_V = 0.05;
  Valve<double> valve = make_valve(effects);
  CHECK(spool_after(valve, 0.049) == 0.0);
  CHECK(spool_after(valve, 0.051) == 0.051);
  CHECK(spool_after(valve, 0.010) == 0.051);
  CHECK(spool_after(valve, 0.0) == 0.0);
}

TEST_CASE("valve: an underlap opens both edges about the centre") {
  ValveEffects<double> effects;
  effects.valve_dead_band.width_V = -0.02;
  const Valve<double> valve = make_valve(effects);
  CHECK(valve.areas(0.0).supply == Approx(2.6e-6 * 0.02));
  CHECK(valve.areas(0.0).exhaust == Approx(2.6e-6 * 0.02));
  CHECK(valve.areas(0.015).supply == Approx(2.6e-6 * 0.035));
  CHECK(valve.areas(0.015).exhaust == Approx(2.6e-6 * 0.005));
  CHECK(valve.areas(-1.0).supply == 0.0);
  CHECK(valve.areas(-1.0).exhaust == Approx(2.6e-6 * 1.02));
}

TEST_CASE("valve: the command is limited to its range") {
  Valve<double> valve = make_valve();
  CHECK(spool_after(valve, 9.0) == Approx(5.0));
  CHECK(spool_after(valve, -9.0) == Approx(-5.0));
}

TEST_CASE("valve: hysteresis is a play of its total width") {
  ValveEffects<double> effects;
  effects.valve_hysteresis.width_V = 0.4;
  Valve<double> valve = make_valve(effects);
  CHECK(spool_after(valve, 0.1) == Approx(0.0).margin(1e-15));
  CHECK(spool_after(valve, 1.0) == Approx(0.8));
  CHECK(spool_after(valve, 0.7) == Approx(0.8));   // still inside the play
  CHECK(spool_after(valve, -1.0) == Approx(-0.8));
  CHECK(spool_after(valve, -0.7) == Approx(-0.8));
  double area = 0.0, before = -0.8;  // the loop's area is width times twice the amplitude of the spool
  for (int k = 0; k <= 8000; ++k) {
    const double command = -std::cos(2.0 * M_PI * k / 4000.0), spool = spool_after(valve, command);
    if (k > 4000) area += command * (spool - before);
    before = spool;
  }
  CHECK(area == Approx(0.4 * 1.6).epsilon(5e-3));
}

TEST_CASE("valve: first-order lag and immediate spool") {
  ValveEffects<double> effects;
  effects.valve_lag.time_constant_s = 0.01;
  Valve<double> valve = make_valve(effects, 2.5e-4);
  valve.set_command(2.0);
  for (int k = 0; k < 40; ++k) valve.step(2.5e-4 * (k % 4));
  CHECK(valve.spool() == Approx(2.0 * (1.0 - std::exp(-1.0))).epsilon(1e-12));
  Valve<double> at_once = make_valve();
  CHECK(spool_after(at_once, 1.5) == 1.5);
}

TEST_CASE("valve: dead time delays by exactly its length, also between the periods") {
  for (const double delay : {0.0, 0.002, 0.0025, 0.00275, 0.02}) {
    ValveEffects<double> effects;
    effects.command_delay.delay_s = delay;
    Valve<double> valve = make_valve(effects, 2.5e-4);
    double first = -1.0;
    for (int k = 0; k < 60; ++k) {
      valve.set_command(k >= 10 ? 1.0 : 0.0);
      for (int i = 0; i < 4; ++i) {
        valve.step(i * 2.5e-4);
        if (first < 0.0 && valve.spool() > 0.5) first = k * 1e-3 + i * 2.5e-4;  // start of the first sub-step with it
      }
    }
    CAPTURE(delay);
    CHECK(first == Approx(0.010 + delay).margin(1e-9));
  }
}

TEST_CASE(
    "second-order filter: step response against the closed form, under-, critically and overdamped, for any step") {
  const double f = 100.0, w = 2.0 * M_PI * f;
  const auto closed = [&](double zeta, double t) {
    if (zeta < 1.0) {
      const double d = w * std::sqrt(1.0 - zeta * zeta);
      return 1.0 - std::exp(-zeta * w * t) * (std::cos(d * t) + zeta * w / d * std::sin(d * t));
    }
    if (zeta == 1.0) return 1.0 - std::exp(-w * t) * (1.0 + w * t);
    const double r = w * std::sqrt(zeta * zeta - 1.0), a = -zeta * w + r, b = -zeta * w - r;
    return 1.0 + (b * std::exp(a * t) - a * std::exp(b * t)) / (a - b);
  };
  for (const double zeta : {0.2, 0.7, 1.0, 3.0}) {
    for (const double step : {1e-4, 2.5e-4, 1e-3}) {
      SecondOrderFilter<double> spool;
      spool.configure(f, zeta, step);
      spool.reset(0.0);
      for (int k = 1; k <= 20; ++k) {
        spool.step(1.0);
        CAPTURE(zeta, step, k);
        CHECK(spool.value() == Approx(closed(zeta, k * step)).margin(1e-9));
      }
    }
  }
}

TEST_CASE("second-order filter: the mean over a step is the mean of the output") {
  SecondOrderFilter<double> coarse, fine, at_once;
  coarse.configure(100.0, 0.7, 1e-3);
  fine.configure(100.0, 0.7, 1e-6);
  at_once.configure(0.0, 0.7, 1e-3);
  for (auto* lag : {&coarse, &fine, &at_once}) lag->reset(0.3);
  for (const double input : {1.0, -0.5, 0.2}) {
    coarse.step(input);
    at_once.step(input);
    double sum = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const double before = fine.value();
      fine.step(input);
      sum += 0.5 * (before + fine.value());
    }
    CHECK(coarse.mean() == Approx(sum / 1000).margin(1e-6));
    CHECK(at_once.mean() == input);
  }
}

namespace {
ValveParameters<double> on_off_parameters(double on_s, double off_s) {
  ValveParameters<double> p{24.0, 1e-6 / 24.0, 1e-6, 0.35};
  p.on_off = {.carrier_period_s = 0.02, .switching_time_on_s = on_s, .switching_time_off_s = off_s};
  return p;
}
/// For how long the edges are open under coil commands of one period each, in sub-steps of a quarter of it [s].
PortAreas<double> open_s(const ValveParameters<double>& p, const std::vector<double>& commands_V) {
  Valve<double> valve = make_valve({}, 0.25e-3, p);
  PortAreas<double> sum{};
  for (const double command_V : commands_V) {
    valve.set_command(command_V);
    for (int i = 0; i < 4; ++i) {
      const PortAreas<double> areas = valve.step(0.25e-3 * i);
      sum.supply += 0.25e-3 * areas.supply / p.area_max_m2;
      sum.exhaust += 0.25e-3 * areas.exhaust / p.area_max_m2;
    }
  }
  return sum;
}
}  // namespace

TEST_CASE("on/off valves open and close their switching times after their coil, one for each sign of the command") {
  const auto p = on_off_parameters(3.1e-3, 2.3e-3);
  const PortAreas<double> filling = open_s(p, {24, 24, 24, 24, 24, 0, 0, 0, 0, 0});
  CHECK(filling.supply == Approx(5e-3 + 2.3e-3 - 3.1e-3));
  CHECK(filling.exhaust == 0.0);
  const PortAreas<double> emptying = open_s(p, {-24, -24, -24, -24, 0, 0, 0});
  CHECK(emptying.supply == 0.0);
  CHECK(emptying.exhaust == Approx(4e-3 + 2.3e-3 - 3.1e-3));
  CHECK(open_s(p, {24, 24, 24, 0, 0, 0, 0}).supply == 0.0);  // shorter than the time to open
  CHECK(open_s(p, {24, 24, 24, 24, 24, 0, 0, 24, 24}).supply == Approx(9e-3 - 3.1e-3));  // a gap too short to close
  const PortAreas<double> both = open_s(p, {24, 24, 24, 24, 24, -24, -24, -24, -24, -24, 0, 0, 0});
  CHECK(both.supply == Approx(4.2e-3));
  CHECK(both.exhaust == Approx(4.2e-3));
}

TEST_CASE("on/off valves leak where they are shut, and the one that empties has the area that the ratio says") {
  ValveEffects<double> effects;
  effects.valve_neutral_leak.area_m2 = 1e-8;
  effects.valve_asymmetry.exhaust_ratio = 0.5;
  Valve<double> valve = make_valve(effects, 1e-3, on_off_parameters(0.0, 0.0));
  const auto areas = [&](double command_V) {
    valve.set_command(command_V);
    return valve.step(0.0);
  };
  CHECK(areas(11.0).supply == Approx(1e-8));  // less than half: the coil is off
  CHECK(areas(24.0).supply == Approx(1e-6 + 1e-8));
  CHECK(areas(-24.0).exhaust == Approx(0.5e-6 + 1e-8));
  CHECK(areas(-24.0).supply == Approx(1e-8));
}
