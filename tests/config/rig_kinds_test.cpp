// Each kind of rig has its own sections and keys: read, dumped, found by path, and refused where they belong to
// another.
#include <catch2/catch.hpp>

#include <string>

#include "config/config_manual.hpp"
#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "config/rig_parameters.hpp"
#include "config/same_rig.hpp"
#include "config/test_rigs.hpp"

using namespace pneuservo;
using test::refusal;

namespace {

const std::string driven_axis = R"(format: pneuservo-rig/1
name: screw
rig: driven_axis
period_s: 0.001
slider: {mass_kg: 9.0, payload_kg: 3.0, viscous_friction_Ns_per_m: 44.0, stroke_m: 0.77, force_max_N: 300.0}
sensors: {position: {quantum_m: 1.0e-6}, force: {quantum_N: 0.01}}
controller: {kind: pd_force, position_gain_N_per_m: 18100, velocity_gain_Ns_per_m: 655, velocity_filter_s: 0.003}
reference: {kind: sine, amplitude_m: 0.16, frequency_Hz: 1.1}
tolerances: {slider.mass_kg: 0.01}
)";

const std::string servo_table = R"(format: pneuservo-rig/1
name: table
rig: servo_table
period_s: 0.0002
supply: {pressure_Pa: 251300}
valve: {command_max_V: 1.6, area_per_volt_m2_per_V: 3.1226e-6, area_max_m2: 5.0e-6, critical_pressure_ratio: 0.4, natural_frequency_Hz: 100}
line_1: {length_m: 0.5, diameter_m: 0.004, model: distributed, natural_frequency_Hz: 110, damping_ratio: 0.068}
line_2: {length_m: 0.5, diameter_m: 0.004, natural_frequency_Hz: 110, damping_ratio: 0.068}
cylinder: {stroke_m: 0.140, area_1_m2: 1.2e-3, area_2_m2: 1.2e-3, dead_volume_1_m3: 1.08e-4, dead_volume_2_m3: 1.08e-4, wall_heat_W_per_m2K: 50.0}
slider: {mass_kg: 26.0, viscous_friction_Ns_per_m: 0.0}
sensors: {position: {quantum_m: 6.25e-11}, port_pressure: {quantum_Pa: 100, noise_Pa: 300}}
controller:
  kind: ppd2
  position_gain_V_per_m: 1200
  velocity_gain_Vs_per_m: 54
  acceleration_gain_Vs2_per_m: 1.3
  observer: error
  observer_gains: [530.5, 140739.9, 1.85e7]
  feedforward: 5
  mean_pressure_Pa: 135000
reference: {kind: cruise, start_m: -0.05, end_m: 0.05, speed_mps: 0.0597, ramp_s: 0.156, start_s: 0.2}
duration_s: 3.0
)";

}  // namespace

TEST_CASE("a driven axis has slider, force sensor and the outer loop alone", "[config]") {
  const Rig rig = parse_rig(driven_axis, "rig.yaml");
  CHECK(rig.kind == RigKind::driven_axis);
  CHECK(rig.axis.slider.mass_kg == 9.0);
  CHECK(rig.axis.cylinder.stroke_m == 0.77);
  CHECK(rig.drive.force_max_N == 300.0);
  CHECK(rig.sensors.force.quantum_N == 0.01);
  CHECK(rig.controller.of<PdForce>().position_gain_N_per_m == 18100.0);
  CHECK(same_rig(rig, parse_rig(dump_rig(rig), "dump")));
  CHECK(get_parameter(rig, "slider.stroke_m") == 0.77);
  CHECK(has_parameter(rig, "effects.coulomb_friction.force_N"));
  CHECK(has_parameter(rig, "effects.sensor_gain:F.gain"));
  CHECK_FALSE(has_parameter(rig, "valve.command_max_V"));
  CHECK_FALSE(has_parameter(rig, "effects.chamber_leak_1.area_m2"));
  CHECK_FALSE(has_parameter(rig, "effects.sensor_gain:p1_port.gain"));
}

TEST_CASE("what belongs to another kind of rig is refused with its line", "[config]") {
  using Catch::Matchers::Contains;
  CHECK_THAT(refusal(driven_axis + "supply: {pressure_Pa: 7e5}\n"), Contains("rig.yaml:10") && Contains("supply"));
  CHECK_THAT(refusal(driven_axis + "effects: {piston_leak: {area_m2: 1e-8}}\n"), Contains("an unknown effect"));
  CHECK_THAT(refusal(driven_axis, {"controller.force_gain_V_per_N=1"}), Contains("controller.force_gain_V_per_N"));
  CHECK_THAT(refusal(driven_axis, {"controller.kind=ppd2"}), Contains("expected pd_force, the law of a driven_axis"));
  CHECK_THAT(refusal(driven_axis, {"reference.amplitude_m=0.5"}), Contains("slider.stroke_m"));
  CHECK_THAT(refusal(driven_axis, {"initial.position_m=0.5"}), Contains("initial.position_m"));
  CHECK_THAT(refusal(servo_table, {"controller.pressure_source=valve"}), Contains("controller.pressure_source"));
  CHECK_THAT(refusal(servo_table, {"controller.kind=pd_force"}), Contains("controller."));
  CHECK_THAT(refusal(servo_table, {"controller.observer_gains=[1, 2]"}), Contains("three: l1, l2, l3"));
  CHECK_THAT(refusal(servo_table, {"line_2.model=second_order_lag"}), Contains("line_2.model"));
  CHECK_THAT(refusal(servo_table, {"controller.feedforward=none", "line_1.model=second_order_lag",
                                   "line_2.model=second_order_lag", "line_1.natural_frequency_Hz=0"}),
             Contains("line_1.natural_frequency_Hz"));
  CHECK_THAT(refusal(servo_table, {"cylinder.linear_about_Pa=110000"}),
             Contains("cylinder.linear_about_Pa") && Contains("line_1.model: second_order_lag"));
  const std::vector<std::string> lags{"controller.feedforward=none", "line_1.model=second_order_lag",
                                      "line_2.model=second_order_lag", "line_1.natural_frequency_Hz=0",
                                      "line_2.natural_frequency_Hz=0"};
  const auto about = [&](const char* pressure_Pa) {
    std::vector<std::string> sets = lags;
    sets.push_back(std::string("cylinder.linear_about_Pa=") + pressure_Pa);
    return sets;
  };
  CHECK(parse_rig(servo_table, "rig.yaml", about("110000")).axis.cylinder.linear_about_Pa == 110000.0);
  for (const char* pressure_Pa : {"90000", "1.9e6"})
    CHECK_THAT(refusal(servo_table, about(pressure_Pa)),
               Contains("cylinder.linear_about_Pa") && Contains("air.atmosphere_Pa"));
  CHECK_THAT(refusal(servo_table + "effects: {sensor_gain:F: {gain: 2}}\n"), Contains("an unknown effect"));
}

TEST_CASE("a servo table has the keys of its law and starts at the pressure that its feedforward counts on",
          "[config]") {
  const Rig rig = parse_rig(servo_table, "rig.yaml");
  CHECK(rig.controller.kind == kind_of<Ppd2>);
  CHECK(rig.controller.of<Ppd2>().feedforward == FeedforwardKind::order_5);
  CHECK(rig.controller.of<Ppd2>().observer_gains == std::vector<double>{530.5, 140739.9, 1.85e7});
  CHECK(rig.initial.pressure_1_Pa == rig.controller.of<Ppd2>().equilibrium_pressure_Pa);
  CHECK(parse_rig(servo_table, "rig.yaml", {"controller.feedforward=flatness"}).initial.pressure_1_Pa == 135000.0);
  CHECK(same_rig(rig, parse_rig(dump_rig(rig), "dump")));
  CHECK(get_parameter(rig, "controller.mean_pressure_Pa") == 135000.0);
}

TEST_CASE("effects that contradict a pressure rig are refused, known or concealed", "[config]") {
  const auto found = [](const std::string& set) -> std::string {
    try {
      read_rig(PNEUSERVO_SOURCE_DIR "/config/pressure-3m-4mm.yaml", {set});
    } catch (const InputError& error) { return error.what(); }
    return "accepted";
  };
  CHECK(found("effects={supply_swing: {amplitude_Pa: 50000, frequency_Hz: 1}}") == "accepted");
  for (const std::string section : {"effects", "concealed"})
    CHECK_THAT(found(section + "={supply_swing: {amplitude_Pa: 650000, frequency_Hz: 1}}"),
               Catch::Contains(section + ".supply_swing.amplitude_Pa: found 650000, expected at most what the supply"));
}

TEST_CASE("the manual gives no number for the initial pressure of a pressure rig, which its atmosphere sets",
          "[config]") {
  CHECK_THAT(config_manual(), Catch::Contains("| see help | hose and volume, absolute; default: atmosphere |"));
}

TEST_CASE("two on/off valves have switching times, pulses of whole periods, and nothing of a spool", "[config]") {
  const auto found = [](const std::vector<std::string>& sets) -> std::string {
    try {
      read_rig(PNEUSERVO_SOURCE_DIR "/config/pressure-on-off-3m-4mm.yaml", sets);
    } catch (const InputError& error) { return error.what(); }
    return "accepted";
  };
  CHECK(found({}) == "accepted");
  CHECK(found({"effects={valve_neutral_leak: {area_m2: 1e-9}, valve_asymmetry: {exhaust_ratio: 0.5}}"}) == "accepted");
  CHECK_THAT(found({"on_off_valves.carrier_period_s=0.0205"}),
             Catch::Contains("on_off_valves.carrier_period_s: found 0.0205, expected a whole number of period_s"));
  CHECK_THAT(found({"on_off_valves.carrier_period_s=0.005"}), Catch::Contains("found 0.005, expected at least 0.006"));
  CHECK_THAT(found({"safe_output.command_V=0.1"}), Catch::Contains("safe_output.command_V: found 0.1, expected 0 or"));
  CHECK_THAT(found({"valve.natural_frequency_Hz=100"}), Catch::Contains("expected 0 or nothing"));
  for (const std::string section : {"effects", "concealed"})
    CHECK_THAT(found({section + "={valve_dead_band: {width_V: 0.2}}"}),
               Catch::Contains(section + ".valve_dead_band: found an effect of a spool"));
  const Rig rig = read_rig(PNEUSERVO_SOURCE_DIR "/config/pressure-on-off-3m-4mm.yaml");
  REQUIRE(rig.axis.valve.on_off);
  CHECK(rig.axis.valve.on_off->switching_time_on_s == 3e-3);
  CHECK(same_rig(rig, parse_rig(dump_rig(rig), "dump")));
}
