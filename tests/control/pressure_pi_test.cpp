// The law of a pressure behind a hose: its reference, the valve's inverse, the gain with its margin, no wind-up.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include <pneuservo/control/pressure_pi.hpp>
#include <pneuservo/control/pressure_reference.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/rig/axis.hpp>

using namespace pneuservo;

namespace {

/// 3 m of 4 mm to 0.5 l behind a valve of 5 mm2 at 700 kPa.
struct HoseAxis {
  AxisParameters<double> axis;
  ElasticVolumeParameters<double> volume{.volume_m3 = 0.5e-3};
  Reference none;
  HoseAxis() {
    axis.supply.pressure_Pa = 7e5;
    axis.valve = {.command_max_V = 5.0,
                  .area_per_volt_m2_per_V = 1e-6,
                  .area_max_m2 = 5e-6,
                  .critical_pressure_ratio = 0.35,
                  .natural_frequency_Hz = 100.0};
    axis.line_1 = {.length_m = 3.0, .diameter_m = 0.004};
  }
  LawSetup setup() const { return {axis, 1e-3, none, 10.0, {}, &volume}; }
};

ControlInput resting_input(double p_Pa) {
  ControlInput in;
  in.pressure_Pa = in.port_Pa = {p_Pa, p_Pa};
  in.now.d[0] = p_Pa;
  return in;
}

/// Flow that the valve of that axis lets into a port [kg/s].
double flow_of_valve(const HoseAxis& rig, double command_V, double port_Pa) {
  const Air<double> air(rig.axis.air);
  const double area = std::fabs(command_V) * rig.axis.valve.area_per_volt_m2_per_V;
  const double other_Pa = command_V > 0.0 ? rig.axis.supply.pressure_Pa : air.atmosphere_Pa;
  return orifice_mass_flow(air, area, rig.axis.valve.critical_pressure_ratio, other_Pa, air.temperature_K, port_Pa,
                           air.temperature_K);
}

}  // namespace

TEST_CASE("steps of a pressure count from their times on, waypoints are smooth between theirs") {
  PressureReferenceParameters p;
  p.times_s = {1.0, 2.0};
  p.pressures_Pa = {3e5, 4e5};
  const PressureReference steps(p);
  CHECK(steps.at(0.0).d[0] == 3e5);
  CHECK(steps.at(1.999).d[0] == 3e5);
  CHECK(steps.at(2.0).d[0] == 4e5);
  CHECK(steps.at(99.0).d[0] == 4e5);
  CHECK(steps.at(2.0).d[1] == 0.0);
  p.kind = PressureReferenceKind::waypoints;
  const PressureReference smooth(p);
  CHECK(smooth.at(1.5).d[0] == Approx(3.5e5));
  CHECK(smooth.at(1.5).d[1] == Approx(1.875e5));  // 15/8 of the mean rate in the middle of a polynomial of degree 5
  CHECK(smooth.at(2.5).d[0] == Approx(4e5));
  CHECK(smooth.range_Pa(3.0).maximum == Approx(4e5));
  p.times_s = {2.0, 1.0};
  CHECK_THROWS_WITH(PressureReference(p), Catch::Contains("reference.times_s: found 1"));
  p.times_s = {1.0};
  CHECK_THROWS_WITH(PressureReference(p),
                    Catch::Contains("reference.pressures_Pa: found 2 pressures, expected as many"));
}

TEST_CASE("the command lets the flow pass that hose and volume need for the reference's rate") {
  HoseAxis rig;
  PressurePi law;
  law.configure({}, rig.setup());
  const double volume_m3 = rig.volume.volume_m3 + rig.axis.line_1.volume_m3();
  for (const double rate : {1e5, -1e5}) {
    law.reset({});
    ControlInput in = resting_input(4e5);
    in.now.d[1] = rate;
    const ControlOutput out = law.step(in);
    // dm/dt = V/(kappa R T) dp/dt of adiabatic gas.
    const double expected = volume_m3 * rate / (1.4 * 287.0 * 293.0);
    CHECK(law.terms().flow_wanted_kgps == Approx(expected));
    CHECK(flow_of_valve(rig, out.command_V[0], 4e5) == Approx(expected));
    CHECK(out.command_V[1] == out.command_V[0]);
    CHECK_FALSE(out.limited);
  }
}

TEST_CASE("what the config knows of the volume's growth and the valve's offset is in the command") {
  HoseAxis rig;
  rig.volume.compliance_m3_per_Pa = 1e-9;
  rig.axis.effects.valve.valve_offset.offset_V = 0.1;
  PressurePi law;
  law.configure({}, rig.setup());
  ControlInput in = resting_input(4e5);
  in.now.d[1] = 1e5;
  const ControlOutput out = law.step(in);
  const double gas_m3 = 0.5e-3 + rig.axis.line_1.volume_m3() + 1e-9 * (4e5 - 101325.0);
  CHECK(law.terms().flow_wanted_kgps == Approx((gas_m3 / 1.4 + 1e-9 * 4e5) * 1e5 / (287.0 * 293.0)));
  CHECK(flow_of_valve(rig, out.command_V[0] + 0.1, 4e5) == Approx(law.terms().flow_wanted_kgps));
  law.reset({});
  CHECK(law.step(resting_input(4e5)).command_V[0] == Approx(-0.1));  // closed is where the offset puts it
}

TEST_CASE("the command opens the edges as far as the valve that the config knows needs") {
  HoseAxis rig;
  auto& effects = rig.axis.effects.valve;
  SECTION("overlapped") { effects.valve_dead_band.width_V = 0.3; }
  SECTION("underlapped, with an offset") {
    effects.valve_dead_band.width_V = -0.2;
    effects.valve_offset.offset_V = 0.1;
  }
  SECTION("curved") { effects.valve_curve = {.near_middle = -0.8, .wide_open = 0.7}; }
  SECTION("a peak within its range") { effects.valve_curve.wide_open = -0.9; }
  SECTION("its exhaust edge smaller") { effects.valve_asymmetry.exhaust_ratio = 0.4; }
  SECTION("leaking, too") {
    effects.valve_neutral_leak.area_m2 = 1e-8;
    effects.valve_dead_band.width_V = 0.2;
    effects.valve_asymmetry.exhaust_ratio = 1.5;
  }
  Valve<double> valve;
  valve.configure(rig.axis.valve, effects, 1e-3);
  const Air<double> air(rig.axis.air);
  const auto flow_kgps = [&](double command_V) {
    const PortAreas<double> areas = valve.areas(command_V);
    const auto into_port = [&](double area_m2, double p_Pa) {
      return orifice_mass_flow(air, area_m2, rig.axis.valve.critical_pressure_ratio, p_Pa, air.temperature_K, 4e5,
                               air.temperature_K);
    };
    return into_port(areas.supply, rig.axis.supply.pressure_Pa) + into_port(areas.exhaust, air.atmosphere_Pa);
  };
  PressurePi law;
  law.configure({}, rig.setup());
  for (const double rate : {4e5, 1e5, 1e3, -1e3, -1e5, -2e5}) {
    law.reset({});
    ControlInput in = resting_input(4e5);
    in.now.d[1] = rate;
    const ControlOutput out = law.step(in);
    INFO("rate of " << rate << " Pa/s, command of " << out.command_V[0] << " V");
    CHECK_FALSE(out.limited);
    CHECK(flow_kgps(out.command_V[0]) == Approx(law.terms().flow_wanted_kgps).epsilon(1e-6));
  }
}

TEST_CASE("a command at its range gives the largest flow that the valve has, and the target goes as fast") {
  HoseAxis rig;
  rig.axis.effects.valve.valve_curve.wide_open = -0.9;
  Valve<double> valve;
  valve.configure(rig.axis.valve, rig.axis.effects.valve, 1e-3);
  double widest_m2 = 0.0;
  for (double u_V = 0.0; u_V <= 5.0; u_V += 1e-3) widest_m2 = std::max(widest_m2, valve.areas(u_V).supply);
  PressurePi law;
  law.configure({}, rig.setup());
  ControlInput in = resting_input(4e5);
  in.now.d[1] = 1e8;
  const ControlOutput out = law.step(in);
  CHECK(out.limited);
  CHECK(law.terms().limit == limit_upper);
  CHECK(valve.areas(out.command_V[0]).supply == Approx(widest_m2));
  CHECK(law.terms().u_unlimited_V > out.command_V[0]);
  CHECK(law.terms().target_rate_Pa_per_s < 1e7);
}

TEST_CASE("the loop of the pressure at the port has a margin of its own, and a limit to its gain") {
  const HoseAxis rig;
  const PressureGains gains = pressure_gains(rig.setup(), PressureSource::valve);
  CHECK(pressure_sensitivity(rig.setup(), PressureSource::valve, gains) <= PressurePi::most_sensitivity);
  const PressureGains far = pressure_gains(rig.setup(), PressureSource::chamber);
  CHECK(gains.gain_per_s != far.gain_per_s);
  CHECK(std::isinf(pressure_sensitivity(rig.setup(), PressureSource::valve, {1000.0, gains.filter_rad_per_s})));
  PressurePiParameters parameters;
  parameters.pressure_source = PressureSource::valve;
  PressurePi law;
  law.configure(parameters, rig.setup());
  CHECK(law.gains().gain_per_s == gains.gain_per_s);
}

TEST_CASE("the least gain that a config can state has its margin behind the longest and narrowest hose of a config") {
  HoseAxis rig;
  rig.axis.line_1 = {.length_m = 100.0, .diameter_m = 5e-4};
  rig.axis.effects.valve.command_delay.delay_s = 0.5;
  for (const double volume_m3 : {1e-7, 10.0}) {
    rig.volume.volume_m3 = volume_m3;
    const PressureGains gains = pressure_gains(rig.setup(), PressureSource::estimated);
    CHECK(gains.gain_per_s >= PressurePiParameters::least_gain_per_s);
    CHECK(pressure_sensitivity(rig.setup(), PressureSource::estimated, gains) <= PressurePi::most_sensitivity);
  }
}

TEST_CASE("the derived gain is the highest with a sensitivity of 2, and falls with the hose's length") {
  HoseAxis rig;
  const PressureGains gains = pressure_gains(rig.setup(), PressureSource::estimated);
  const auto times = [&](double factor) { return PressureGains{factor * gains.gain_per_s, gains.filter_rad_per_s}; };
  CHECK(pressure_sensitivity(rig.setup(), PressureSource::estimated, gains) <= PressurePi::most_sensitivity);
  CHECK(pressure_sensitivity(rig.setup(), PressureSource::estimated, times(1.03)) > PressurePi::most_sensitivity);
  CHECK(std::isinf(pressure_sensitivity(rig.setup(), PressureSource::estimated, times(4.0))));
  // Without the filter the hose's resonance sets the gain.
  CHECK(pressure_sensitivity(rig.setup(), PressureSource::estimated, {gains.gain_per_s, 1e6}) >
        PressurePi::most_sensitivity);
  double last = infinite;
  // The table of docs/physics/pressure_pi.md.
  for (const auto& [length_m, told_per_s] : {std::pair{1.0, 104.0}, {3.0, 39.0}, {10.0, 11.0}}) {
    rig.axis.line_1.length_m = length_m;
    const double here = pressure_gains(rig.setup(), PressureSource::estimated).gain_per_s;
    CHECK(here == Approx(told_per_s).epsilon(0.03));
    CHECK(here < last);
    last = here;
  }
  PressurePi law;
  law.configure({.gain_per_s = 3.0}, rig.setup());
  CHECK(law.gains().gain_per_s == 3.0);
}

TEST_CASE("a supply that cannot give the pressure winds nothing up") {
  HoseAxis rig;
  PressurePi law;
  law.configure({}, rig.setup());
  ControlInput in = resting_input(4e5);
  law.step(in);
  in.now.d[0] = 6e5;
  in.supply_Pa = 4e5;  // the supply has gone
  for (int i = 0; i < 5000; ++i) CHECK(law.step(in).finite);
  CHECK(law.terms().limit == limit_upper);
  CHECK(law.terms().p_target_Pa == Approx(4e5).margin(1e3));
  CHECK(std::fabs(law.terms().error_integral_Pas) < 10.0);
  in.now.d[0] = 4e5;
  in.supply_Pa = 7e5;  // it is back, and nobody wants more any longer
  for (int i = 0; i < 100; ++i) law.step(in);
  CHECK(std::fabs(law.step(in).command_V[0]) < 0.1);
}

TEST_CASE("an input that is not finite keeps the last command and says so") {
  HoseAxis rig;
  PressurePi law;
  law.configure({}, rig.setup());
  ControlInput in = resting_input(4e5);
  in.now.d[1] = 1e5;
  const double last_V = law.step(in).command_V[0];
  const int missing = GENERATE(0, 1, 2);
  CAPTURE(missing);
  if (missing != 0) in.port_Pa = {NAN, NAN};
  if (missing != 1) in.pressure_Pa = {NAN, NAN};
  const ControlOutput out = law.step(in);
  CHECK_FALSE(out.finite);
  CHECK(out.command_V[0] == last_V);
}

TEST_CASE("pulses have their margin too, and the gain falls with their carrier period") {
  HoseAxis rig;
  const double proportional = pressure_gains(rig.setup(), PressureSource::estimated).gain_per_s;
  rig.axis.valve.natural_frequency_Hz = 0.0;
  double last = proportional;
  for (const double carrier_s : {0.02, 0.04, 0.1}) {
    rig.axis.valve.on_off = {.carrier_period_s = carrier_s, .switching_time_on_s = 3e-3, .switching_time_off_s = 2e-3};
    const PressureGains gains = pressure_gains(rig.setup(), PressureSource::estimated);
    CHECK(pressure_sensitivity(rig.setup(), PressureSource::estimated, gains) <= PressurePi::most_sensitivity);
    CHECK(gains.gain_per_s < last);
    last = gains.gain_per_s;
  }
}

TEST_CASE("the law of two on/off valves switches them on and off, and their mean flow is the one it wants") {
  HoseAxis rig;
  auto& parameters = rig.axis.valve;
  parameters.natural_frequency_Hz = 0.0;
  parameters.on_off = {.carrier_period_s = 0.02, .switching_time_on_s = 3e-3, .switching_time_off_s = 2e-3};
  constexpr int ticks = 4000;
  PressurePi law;
  law.configure({}, rig.setup());
  Valve<double> valve;
  valve.configure(parameters, {}, 1e-3);
  valve.set_time_step(1e-3);
  for (const double rate : {4e5, 3e4, -5e4}) {
    law.reset({});
    valve.reset(0.0);
    double passed_kg = 0.0, wanted_kg = 0.0;
    ControlInput in = resting_input(4e5);
    for (int i = 0; i < ticks; ++i) {  // the pressure follows as late as the hose is, the port stays at 4 bar
      in.now.d[0] = 4e5 + rate * 1e-3 * i;
      in.now.d[1] = rate;
      in.pressure_Pa.fill(in.now.d[0] - rate * law.delay_s());
      const double command_V = law.step(in).command_V[0];
      CHECK((command_V == 0.0 || std::fabs(command_V) == parameters.command_max_V));
      valve.set_command(command_V);
      const PortAreas<double> areas = valve.step(0.0);
      const double unit = parameters.area_per_volt_m2_per_V;
      passed_kg +=
          1e-3 * (flow_of_valve(rig, areas.supply / unit, 4e5) + flow_of_valve(rig, -areas.exhaust / unit, 4e5));
      wanted_kg += 1e-3 * law.terms().flow_wanted_kgps;
    }
    CAPTURE(rate);
    // No more is owed than a shortest pulse, which opens for 3 ms, and one period.
    const double full_kgps = std::fabs(flow_of_valve(rig, std::copysign(parameters.command_max_V, rate), 4e5));
    CHECK(std::fabs(passed_kg - wanted_kg) <= full_kgps * 4e-3);
    CHECK(std::fabs(wanted_kg) > full_kgps * 20e-3);
  }
}
