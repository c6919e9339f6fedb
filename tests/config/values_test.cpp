// Values land where they belong: defaults, every kind of reference, effects, --set, numbers by path.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

#include "config/input_error.hpp"
#include "config/key_suggestion.hpp"
#include "config/number_text.hpp"
#include "config/read_rig.hpp"
#include "config/rig_parameters.hpp"
#include "config/test_rigs.hpp"

using namespace pneuservo;
using test::plain_rig;
using test::with;

namespace {
Rig rig_with_reference(const std::string& reference, const std::vector<std::string>& overrides = {}) {
  std::string text = with(plain_rig, "{kind: sine, amplitude_m: 0.080, frequency_Hz: 1.0}", reference);
  return parse_rig(with(text, "duration_s: 5.0\n", ""), "rig.yaml", overrides);
}
}  // namespace

TEST_CASE("what the config leaves out has the members' defaults") {
  const Rig rig = parse_rig(plain_rig, "rig.yaml");
  CHECK(rig.name == "plain");
  CHECK(rig.axis.air.viscosity_Pas == 1.8e-5);
  CHECK(rig.axis.valve.damping_ratio == 0.7);
  CHECK(rig.axis.line_2.turbulent_reynolds == 4000.0);
  CHECK(rig.controller.of<PdForce>().command_rate_V_per_s == infinite);
  CHECK(rig.seed == 1);
  CHECK_FALSE(rig.evaluation.has_value());
  CHECK_FALSE(rig.initial.pressure_2_Pa.has_value());
  CHECK(rig.reference.ramp_s < 0.0);
  CHECK(rig.reference.smoothness == 5);
}

TEST_CASE("the contract's own words for a reference read") {
  const Rig multisine = rig_with_reference("{kind: multisine, components: [[0.01, 2, 0.5], [0.02, 0.5, -1]], center_m: "
                                           "0.01, start_s: 0.3, ramp_s: 0, smoothness: 11}");
  CHECK(multisine.reference.kind == ReferenceKind::multisine);
  CHECK(multisine.reference.components == std::vector<std::array<double, 3>>{{0.01, 2, 0.5}, {0.02, 0.5, -1}});
  CHECK(multisine.reference.ramp_s == 0.0);
  CHECK(multisine.reference.smoothness == 11);
  const Rig cruise =
      rig_with_reference("{kind: cruise, start_m: -0.05, end_m: 0.05, speed_mps: 0.0597, ramp_s: 0.156}");
  CHECK(cruise.reference.smoothness == 9);
  CHECK(cruise.duration_s == Approx(0.1 / 0.0597 + 0.156 + 1.0));
  const Rig move =
      rig_with_reference("{kind: minimum_jerk, start_m: -0.06, end_m: 0.06, duration_s: 0.8, start_s: 0.2}");
  CHECK(move.reference.duration_s == 0.8);
  CHECK(move.duration_s == Approx(2.0));
  const Rig sum = rig_with_reference("{kind: sum, parts: [{kind: waypoints, times_s: [0, 1], positions_m: [0, 0.1]}, "
                                     "{kind: sine, amplitude_m: 0.01, frequency_Hz: 2, start_s: 1}]}");
  REQUIRE(sum.reference.parts.size() == 2);
  CHECK(sum.reference.parts[0].positions_m == std::vector<double>{0, 0.1});
  CHECK(sum.reference.parts[1].frequency_Hz == 2.0);
  CHECK(sum.duration_s == Approx(1 + 0.5 + 5));
}

TEST_CASE("positions of references are those of their equations") {
  const auto position = [](const std::string& text, double t) {
    return Reference(parse_reference(text, "test")).at(t).d[0];
  };
  CHECK(position("{kind: sine, amplitude_m: 0.08, frequency_Hz: 1, ramp_s: 0, center_m: 0.01, start_s: 0.5}", 0.75) ==
        Approx(0.09));
  CHECK(position("{kind: sine, amplitude_m: 0.08, frequency_Hz: 1}", 0.25) ==
        Approx(0.08 * (10 * std::pow(0.25, 3) - 15 * std::pow(0.25, 4) + 6 * std::pow(0.25, 5))));
  CHECK(position("{kind: minimum_jerk, start_m: -0.1, end_m: 0.1, duration_s: 2, start_s: 1}", 2.0) ==
        Approx(0.0).margin(1e-15));
  CHECK(position("{kind: minimum_jerk, start_m: -0.1, end_m: 0.1, duration_s: 2, start_s: 1}", 0.5) == -0.1);
  CHECK(position("{kind: waypoints, times_s: [1, 2, 3], positions_m: [0.02, 0.05, 0.05], smoothness: 3}", 1.25) ==
        Approx(0.02 + 0.03 * (3 * 0.0625 - 2 * 0.015625)));
  const std::string unramped = "{kind: multisine, components: [[0.01, 1, 1.5]], start_s: 0.5, ramp_s: 0}";
  CHECK(position(unramped, 0.2) == Approx(0.01 * std::sin(1.5)));
  const std::string cruise = "{kind: cruise, start_m: 0.05, end_m: -0.05, speed_mps: 0.1, ramp_s: 0.2, start_s: 0.3}";
  CHECK(position(cruise, 0.3) == 0.05);
  CHECK(position(cruise, 0.3 + 0.2) == Approx(0.05 - 0.1 * 0.1));  // half the ramp's time at full speed
  CHECK(position(cruise, 0.3 + 0.6) == Approx(0.0).margin(1e-15));
  CHECK(position(cruise, 0.3 + 1.2) == Approx(-0.05));
  CHECK(position(cruise, 9.0) == Approx(-0.05));
}

TEST_CASE("effects go to the axis and to the sensors") {
  const Rig rig =
      parse_rig(plain_rig + "effects: {coulomb_friction: {force_N: 3}, valve_lag: {time_constant_s: 0.01}, "
                            "sensor_offset:p2_chamber: {offset: -800}, sensor_lag:x: {time_constant_s: 0.002}}\n",
                "rig.yaml");
  CHECK(rig.axis.effects.motion.coulomb_friction.force_N == 3.0);
  CHECK(rig.axis.effects.valve.valve_lag.time_constant_s == 0.01);
  CHECK(rig.sensor_effects[Signal::p2_chamber].sensor_offset.offset == -800.0);
  CHECK(rig.sensor_effects[Signal::x].sensor_lag.time_constant_s == 0.002);
  CHECK(rig.sensor_effects[Signal::p1_port].sensor_gain.gain == 1.0);
}

TEST_CASE("effects of sensors are known wherever the section of sensors stands") {
  const Rig rig = read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/cylinder-2m-6.10mm.yaml",
                           {"effects={'sensor_offset:dp1': {offset: 100}}", "concealed.sensor_gain:dp2.gain=1.1",
                            "sensors.differential_pressure={quantum_Pa: 0, noise_Pa: 0, range_Pa: 100000}"});
  CHECK(rig.sensor_effects[Signal::dp1].sensor_offset.offset == 100.0);
  CHECK(rig.concealed.at("effects.sensor_gain:dp2.gain") == 1.1);
}

TEST_CASE("an override (--set) replaces, adds and goes into lists") {
  const Rig rig = parse_rig(plain_rig, "rig.yaml",
                            {"controller.pressure_source=valve", "line_1.length_m=5", "reference.frequency_Hz=0.5",
                             "effects.coulomb_friction.force_N=3", "tolerances.slider.mass_kg=0.05",
                             "seed=18446744073709551615", "effects.sensor_gain:x.gain=1.01", "line_1.length_m=4"});
  CHECK(rig.controller.of<PdForce>().pressure_source == PressureSource::valve);
  CHECK(rig.axis.line_1.length_m == 4.0);
  CHECK(rig.axis.line_2.length_m == 10.0);
  CHECK(rig.reference.frequency_Hz == 0.5);
  CHECK(rig.axis.effects.motion.coulomb_friction.force_N == 3.0);
  CHECK(rig.tolerances.at("slider.mass_kg") == 0.05);
  CHECK(rig.seed == 18446744073709551615ull);
  CHECK(rig.sensor_effects[Signal::x].sensor_gain.gain == 1.01);
  const Rig listed = rig_with_reference("{kind: multisine, components: [[0.01, 2, 0.5], [0.02, 0.5, -1]]}",
                                        {"reference.components.1.0=0.03"});
  CHECK(listed.reference.components[1][0] == 0.03);
}

/// With its range the sensor itself comes and goes, and with it its effects.
bool makes_a_sensor(const ParameterPath& parameter) {
  return parameter.path == "sensors.differential_pressure.range_Pa";
}

TEST_CASE("a handle is its path, resolved once, in every rig of the kind", "[optimised]") {
  const Rig rig = parse_rig(plain_rig, "rig.yaml");
  for (const ParameterPath& parameter : parameter_paths(rig)) {
    if (makes_a_sensor(parameter)) continue;
    INFO(parameter.path);
    const ParameterHandle handle(rig, parameter.path);
    Rig other = rig;
    CHECK(handle.value(other) == parameter.value);
    const double within = std::clamp(0.625, parameter.field.minimum, parameter.field.maximum);
    handle.set(other, within);
    CHECK(get_parameter(other, parameter.path) == within);
    CHECK(get_parameter(rig, parameter.path) == parameter.value);
    for (const ParameterPath& same : parameter_paths(other))
      if (same.path != parameter.path) CHECK(same.value == get_parameter(rig, same.path));
  }
  CHECK_THROWS_AS(ParameterHandle(rig, "slider.mas_kg"), InputError);
  Rig other = rig;
  CHECK_THROWS_WITH(ParameterHandle(rig, "slider.mass_kg").set(other, -1.0),
                    "parameter: slider.mass_kg: found -1, expected a number in kg, 0.001 to 10000");
  // A number that the config does not state has a place, and no value.
  const ParameterHandle unstated(rig, "initial.pressure_2_Pa");
  CHECK_THROWS_AS(unstated.value(rig), InputError);
  unstated.set(other, 5e5);
  CHECK(other.initial.pressure_2_Pa == 5e5);
}

TEST_CASE("a handle to a part of a reference follows it into copies") {
  const Rig rig = rig_with_reference("{kind: sum, parts: [{kind: sine, amplitude_m: 0.01, frequency_Hz: 2}, {kind: "
                                     "sine, amplitude_m: 0.02, frequency_Hz: 3}]}");
  const ParameterHandle handle(rig, "reference.parts.1.amplitude_m");
  Rig other = rig;
  handle.set(other, 0.03);
  CHECK(other.reference.parts[1].amplitude_m == 0.03);
  CHECK(handle.value(rig) == 0.02);
}

TEST_CASE("numbers are found, read and set by their path") {
  Rig rig = parse_rig(plain_rig, "rig.yaml");
  for (const ParameterPath& parameter : parameter_paths(rig)) {
    INFO(parameter.path);
    CHECK(get_parameter(rig, parameter.path) == parameter.value);
    CHECK(has_parameter(rig, parameter.path));
    CHECK_FALSE(parameter.field.help.empty());
  }
  set_parameter(rig, "effects.sensor_offset:p1_port.offset", 250.0);
  CHECK(rig.sensor_effects[Signal::p1_port].sensor_offset.offset == 250.0);
  set_parameter(rig, "effects.line_leak_2.position", 0.25);
  CHECK(rig.axis.effects.line_leak_2.position == 0.25);
  set_parameter(rig, "reference.amplitude_m", 0.05);
  CHECK(rig.reference.amplitude_m == 0.05);
  set_parameter(rig, "initial.pressure_2_Pa", 5e5);
  CHECK(rig.initial.pressure_2_Pa == 5e5);
  CHECK_THROWS_WITH(set_parameter(rig, "slider.mass_kg", -1.0),
                    "parameter: slider.mass_kg: found -1, expected a number in kg, 0.001 to 10000");
  CHECK_THROWS_AS(set_parameter(rig, "slider.mass_kg", std::nan("")), InputError);
  CHECK_THROWS_WITH(set_parameter(rig, "slider.mas_kg", 1.0), Catch::Contains("did you mean slider.mass_kg?"));
  CHECK_THROWS_AS(get_parameter(rig, "slider"), InputError);
}

TEST_CASE("every number of a rig can be set and is the only one that changes") {
  const Rig original = parse_rig(plain_rig, "rig.yaml");
  const std::vector<ParameterPath> before = parameter_paths(original);
  REQUIRE(before.size() > 80);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (makes_a_sensor(before[i])) continue;
    INFO(before[i].path);
    Rig rig = original;
    const Field& field = before[i].field;
    const double value =
        before[i].value == field.minimum ? std::min(field.maximum, field.minimum + 0.5) : field.minimum;
    set_parameter(rig, before[i].path, value);
    const std::vector<ParameterPath> after = parameter_paths(rig);
    REQUIRE(after.size() == before.size());
    for (std::size_t k = 0; k < after.size(); ++k) REQUIRE(after[k].value == (k == i ? value : before[k].value));
  }
}

TEST_CASE("printed numbers read back to the same bits") {
  const unsigned seed = 20261121;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  for (int i = 0; i < 20000; ++i) {
    const double mantissa = std::uniform_real_distribution<double>(-10, 10)(random);
    const double value = mantissa * std::pow(10.0, std::uniform_int_distribution<int>(-300, 300)(random));
    REQUIRE(number_from_text(number_text(value)) == value);
  }
  CHECK(number_text(700000.0) == "700000");
  CHECK(number_text(0.1) == "0.1");
  CHECK(number_text(2e-6) == "2.0e-06");
  CHECK(number_text(-infinite) == "-.inf");
  for (const char* wrong : {"", "-", "+-1", "1e", "1 ", " 1", "inf", "nan", "0x1p3", "1_000", "--1", "1,5"})
    CHECK_FALSE(number_from_text(wrong).has_value());
  CHECK(number_from_text("+1.5e3") == 1500.0);
  CHECK(number_from_text(".5") == 0.5);
}

TEST_CASE("units have their endings and names their distance") {
  CHECK(unit_suffix("m2/V") == "_m2_per_V");
  CHECK(unit_suffix("J/(kg K)") == "_J_per_kgK");
  CHECK(unit_suffix("V/(N s)") == "_V_per_Ns");
  CHECK(unit_suffix("1/m") == "_per_m");
  CHECK(unit_suffix("m/s") == "_mps");
  CHECK(unit_suffix("-").empty());
  CHECK(edit_distance("supply", "suply") == 1);
  CHECK(edit_distance("length", "lenght") == 1);
  CHECK(edit_distance("", "abc") == 3);
}

TEST_CASE("every key of a rig ends in the letters of its unit") {
  for (const ParameterPath& parameter : parameter_paths(parse_rig(plain_rig, "rig.yaml"))) {
    INFO(parameter.path << " in " << parameter.field.unit);
    CHECK(parameter.path.ends_with(unit_suffix(parameter.field.unit)));
  }
}
