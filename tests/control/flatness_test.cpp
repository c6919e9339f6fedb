// Flatness plan and law: differentiator, rest, steady flow, mean pressure, feedback signs, learning.
#include <catch2/catch.hpp>

#include <pneuservo/control/flatness_law.hpp>
#include <pneuservo/elements/orifice.hpp>

#include "control/smoothing_differentiator.hpp"
#include "control/table_axis.hpp"

using namespace pneuservo;
using test::table_4mm;
using test::table_8mm;

namespace {
Reference cruise(double from_m, double to_m, double speed_mps = 0.0597, double ramp_s = 0.156) {
  ReferenceSpec spec;
  spec.kind = ReferenceKind::cruise;
  spec.start_m = from_m;
  spec.end_m = to_m;
  spec.speed_mps = speed_mps;
  spec.ramp_s = ramp_s;
  spec.start_s = 0.2;
  spec.smoothness = 9;
  return Reference(spec);
}
FlatnessSettings at_pressure(double mean_pressure_Pa) {
  FlatnessSettings settings;
  settings.mean_pressure_Pa = mean_pressure_Pa;
  return settings;
}
}  // namespace

TEST_CASE("smoothing differentiator: exact for the fourth degree, bounded gain, rests at the ends") {
  const double step = 5e-5;
  const SmoothingDifferentiator differentiate(16, step);
  std::vector<double> y(200), rate;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double t = static_cast<double>(i) * step;
    y[i] = 1.0 - 3.0 * t + 2e2 * t * t - 4e4 * t * t * t + 1e6 * t * t * t * t;
  }
  differentiate(y, rate);
  for (std::size_t i = 16; i + 16 < y.size(); ++i) {
    const double t = static_cast<double>(i) * step;
    CHECK(rate[i] == Approx(-3.0 + 4e2 * t - 1.2e5 * t * t + 4e6 * t * t * t).epsilon(1e-9));
  }
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = i % 2 == 0 ? 1.0 : -1.0;  // the worst noise there is
  differentiate(y, rate);
  for (std::size_t i = 16; i + 16 < y.size(); ++i) CHECK(std::fabs(rate[i]) < 0.02 / step);
  y.assign(y.size(), 5.0);
  differentiate(y, rate);
  for (const double r : rate) CHECK(r == 0.0);
}

TEST_CASE("flatness plan: at rest the valves are shut and the ports have the mean pressure") {
  const AxisParameters<double> axis = test::table_axis(table_4mm);
  const FlatnessPlan plan(axis, Reference{}, 0.1, at_pressure(140e3));
  for (std::int64_t k : {-5, 0, 250, 499, 10000}) {
    const FlatnessTick& tick = plan.at(k);
    CHECK(tick.valve_1.command_V(0.0) == Approx(0.0).margin(1e-12));
    CHECK(tick.valve_2.command_V(0.0) == Approx(0.0).margin(1e-12));
    CHECK(tick.mean_port_pressure_Pa == Approx(140e3));
    CHECK(tick.valve_1.volume_share == Approx(1.0));
  }
}

TEST_CASE("flatness plan: in a long slow cruise each valve passes what its chamber takes at ambient temperature") {
  AxisParameters<double> axis = test::table_axis(table_8mm);
  axis.cylinder.wall_heat_W_per_m2K = 1e5;  // keeps the gas at the wall's temperature
  const double p = 140e3, speed = 0.004;
  const FlatnessPlan plan(axis, cruise(-0.03, 0.03, speed, 1.0), 8.0, at_pressure(p));
  const FlatnessTick& tick = plan.at(40000);  // 8 s after ramps of 1 s
  const double flow = p * 1.2e-3 * speed / (287.0 * 293.0);
  CHECK(tick.valve_1.flow_kgps == Approx(flow).epsilon(2e-4));
  CHECK(tick.valve_2.flow_kgps == Approx(-flow).epsilon(2e-4));
  const Air<double> air;
  CHECK(tick.valve_1.command_V(0.0) ==
        Approx(flow / orifice_mass_flow(air, 3.1226e-6, 0.4, 251.3e3, 293.0, p, 293.0)).epsilon(1e-3));
  CHECK(tick.valve_2.command_V(0.0) ==
        Approx(-flow / orifice_mass_flow(air, 3.1226e-6, 0.4, p, 293.0, 101325.0, 293.0)).epsilon(1e-3));
}

TEST_CASE("flatness plan: moving forth and back gives the same commands with the sides exchanged") {
  const AxisParameters<double> axis = test::table_axis(table_4mm);
  const FlatnessPlan forth(axis, cruise(-0.02, 0.02), 1.2, at_pressure(140e3));
  const FlatnessPlan back(axis, cruise(0.02, -0.02), 1.2, at_pressure(140e3));
  for (std::int64_t k = 0; k < 6000; k += 7) {
    CHECK(forth.at(k).valve_1.command_V(0.0) == Approx(back.at(k).valve_2.command_V(0.0)).margin(1e-10));
    CHECK(forth.at(k).valve_2.command_V(0.0) == Approx(back.at(k).valve_1.command_V(0.0)).margin(1e-10));
  }
}

TEST_CASE("flatness plan: a delay of the command is made up for by sending it earlier") {
  const AxisParameters<double> axis = test::table_axis(table_4mm);
  FlatnessSettings late = at_pressure(140e3);
  late.command_delay_s = 4e-4;  // two ticks
  const FlatnessPlan on_time(axis, cruise(-0.02, 0.02), 1.2, at_pressure(140e3));
  const FlatnessPlan early(axis, cruise(-0.02, 0.02), 1.2, late);
  for (std::int64_t k = 0; k < 5900; k += 11)
    CHECK(early.at(k).valve_1.command_V(0.0) == Approx(on_time.at(k + 2).valve_1.command_V(0.0)).margin(1e-7));
}

TEST_CASE(
    "flatness plan: refuses a move that its mean pressure does not suffice for and names the pressure that does") {
  const AxisParameters<double> axis = test::table_axis(table_4mm);
  const Reference move = cruise(-0.05, 0.05);
  const double needed = mean_pressure_needed_Pa(axis, move, 2.5, at_pressure(110e3));
  CHECK(needed > 101325.0 + 26.0 * 0.94 / (2.0 * 1.2e-3));  // m a/(2 A) above atmosphere, and some for the exhaust
  CHECK(needed < 122e3);
  CHECK_NOTHROW(FlatnessPlan(axis, move, 2.5, at_pressure(needed + 500.0)));
  CHECK_THROWS_WITH(FlatnessPlan(axis, move, 2.5, at_pressure(110e3)),
                    Catch::Contains("mean_pressure_Pa 110000 does not suffice") &&
                        Catch::Contains("expected at least " + std::to_string(static_cast<int>(needed))));
  CHECK_THROWS_WITH(FlatnessPlan(axis, cruise(-0.05, 0.05, 1.0, 0.05), 1.0, at_pressure(140e3)),
                    Catch::Contains("longer ramps"));
}

TEST_CASE("flatness law: feedback drives both valves apart, the hold of the mean pressure both alike") {
  const AxisParameters<double> axis = test::table_axis(table_4mm);
  const FlatnessGains gains = flatness_gains(axis, 110e3);
  CHECK(gains.flow_per_volt_kgps == Approx(1.1274e-3).epsilon(1e-3));  // the note's, for K = 45.58
  CHECK(gains.pressure_hold_kgps_per_Pa == Approx(4.57e-9).epsilon(1e-3));
  FlatnessLaw law(FlatnessPlan(axis, Reference{}, 0.1, at_pressure(140e3)), gains, 2e-4);
  const FlatnessCommand rest = law.step(0, 0.0, 0.0, 140e3, 140e3);
  CHECK((rest.valve_1_V == Approx(0.0).margin(1e-12) && rest.valve_2_V == Approx(0.0).margin(1e-12)));
  const FlatnessCommand forward = law.step(1, 0.0, 0.1, 140e3, 140e3);
  const Air<double> air;
  CHECK(forward.valve_1_V * orifice_mass_flow(air, 3.1226e-6, 0.4, 251.3e3, 293.0, 140e3, 293.0) ==
        Approx(0.1 * gains.flow_per_volt_kgps));
  CHECK(forward.valve_2_V * orifice_mass_flow(air, 3.1226e-6, 0.4, 140e3, 293.0, 101325.0, 293.0) ==
        Approx(-0.1 * gains.flow_per_volt_kgps));
  law.reset();
  const FlatnessCommand low_pressure = law.step(2, 0.0, 0.0, 138e3, 138e3);
  CHECK(low_pressure.valve_1_V > 0.0);
  CHECK(low_pressure.valve_1_V == Approx(low_pressure.valve_2_V));
}

TEST_CASE("flatness law: learns an area that is off, and a flow that is missing") {
  const AxisParameters<double> axis = test::table_axis(table_4mm);
  FlatnessLaw law(FlatnessPlan(axis, cruise(-0.02, 0.02), 1.2, at_pressure(140e3)), flatness_gains(axis, 110e3), 2e-4);
  const double F_g = flatness_gains(axis, 110e3).flow_per_volt_kgps;
  const auto missing = [&](std::int64_t k) {
    const FlatnessTick& tick = law.plan().at(k);
    return 0.5 * (tick.valve_1.flow_kgps - tick.valve_2.flow_kgps);
  };
  const auto step = [](FlatnessLaw& one, std::int64_t k, double feedback_V) {  // the mean pressure is as planned
    const double p = one.plan().at(k).mean_port_pressure_Pa;
    return one.step(k, 0.0, feedback_V, p, p);
  };
  // The valves pass 3 % too little: the feedback has to add 1/0.97 - 1 of the flow.
  for (std::int64_t k = 0; k < 6000; ++k) step(law, k, (1.0 / 0.97 - 1.0) * missing(k) / F_g);
  CHECK(law.learn_area(axis) == Approx(0.97).epsilon(5e-4));
  const double with_area = step(law, 2000, 0.0).valve_1_V;
  CHECK(with_area == Approx(law.plan().at(2000).valve_1.command_V(0.0) / 0.97).epsilon(5e-4));

  FlatnessLaw other(FlatnessPlan(axis, cruise(-0.02, 0.02), 1.2, at_pressure(140e3)), flatness_gains(axis, 110e3),
                    2e-4);
  const auto missing_flow = [](std::int64_t k) { return 1e-6 * std::sin(0.005 * static_cast<double>(k)); };
  for (std::int64_t k = 0; k < 6000; ++k) step(other, k, missing_flow(k) / F_g);
  other.learn_flow(axis);
  for (std::int64_t k = 1000; k < 5000; k += 500) {
    const FlatnessTick& tick = other.plan().at(k);
    const double added = (step(other, k, 0.0).valve_1_V - tick.valve_1.correction_V) * tick.valve_1.charge_kgps_per_V;
    if (tick.valve_1.flow_kgps > 1e-5) CHECK(added - tick.valve_1.flow_kgps == Approx(missing_flow(k)).margin(1e-8));
  }
}

TEST_CASE("flatness law: a few skipped ticks are bridged, a move with more than one percent of them teaches nothing") {
  const AxisParameters<double> axis = test::table_axis(table_4mm);
  for (const std::int64_t every : {200, 50}) {
    FlatnessLaw law(FlatnessPlan(axis, cruise(-0.02, 0.02), 1.2, at_pressure(140e3)), flatness_gains(axis, 110e3),
                    2e-4);
    const double p = law.plan().at(2000).mean_port_pressure_Pa;
    const double before = law.step(2000, 0.0, 0.0, p, p).valve_1_V;
    for (std::int64_t k = 0; k < 6000; ++k)
      if (k % every != 0) law.step(k, 0.0, 1e-3, p, p);
    law.learn_flow(axis);
    CAPTURE(every);
    CHECK(law.moves_not_learned() == (every == 50 ? 1 : 0));
    const double learned_V = law.step(2000, 0.0, 0.0, p, p).valve_1_V - before;
    CHECK((std::fabs(learned_V) > 1e-4) == (every == 200));
  }
}

TEST_CASE("flatness plan: the flow of a deviation is that of the linear model where the deviation is slow") {
  AxisParameters<double> axis = test::table_axis(table_4mm);
  axis.cylinder.wall_heat_W_per_m2K = 2e4;  // isothermal chambers
  const FlatnessPlan plan(axis, Reference{}, 1.5, at_pressure(140e3));
  const double amplitude = 1e-6, w = 2.0 * M_PI * 3.0;
  std::vector<double> error(plan.ticks());
  for (std::size_t k = 0; k < error.size(); ++k) error[k] = amplitude * std::sin(w * 2e-4 * static_cast<double>(k));
  const std::vector<double> flow = plan.flow_of_deviation(axis, error);
  // R T G = V m x^(3)/(2 A) + p A x^(1) with the line's volume in V, and the valve's lag of 2 zeta/w at the command.
  const double volume = 1.92e-4 + 0.25 * M_PI * 0.004 * 0.004 * 0.5, smoothing = std::exp(-0.5 * std::pow(w * 3e-3, 2));
  const double size = amplitude * smoothing * w * (140e3 * 1.2e-3 - volume * 26.0 * w * w / 2.4e-3) / (287.0 * 293.0);
  for (std::size_t k = 3000; k < 6500; k += 100) {
    const double t = 2e-4 * (static_cast<double>(k) + 0.5) + 1.4 / (2.0 * M_PI * 100.0);
    CHECK(flow[k] == Approx(size * std::cos(w * t)).margin(0.03 * std::fabs(size)));
  }
}
