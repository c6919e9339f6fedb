// Values that contradict each other, and references that leave the stroke, are refused at the line to blame.
#include <catch2/catch.hpp>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "config/test_rigs.hpp"

using namespace pneuservo;
using test::accepted;
using test::plain_rig;
using test::refusal;
using test::with;

namespace {

std::string refusal_of_reference(const std::string& reference) {
  return refusal(with(plain_rig, "{kind: sine, amplitude_m: 0.080, frequency_Hz: 1.0}", reference));
}

}  // namespace

TEST_CASE("values that contradict each other are refused") {
  CHECK(refusal(with(plain_rig, "length_m: 10.0", "length_m: 10.0\n  laminar_reynolds: 5000")) ==
        "rig.yaml:14: line_1.laminar_reynolds: found 5000, expected at most line_1.turbulent_reynolds (4000)");
  CHECK(refusal(plain_rig, {"line_2.turbulent_reynolds=2000"}) ==
        "--set line_2.turbulent_reynolds=2000: line_2.laminar_reynolds: found 2300, expected at most "
        "line_2.turbulent_reynolds (2000)");
  CHECK(refusal(plain_rig, {"line_2.laminar_reynolds=2300", "line_2.turbulent_reynolds=2300"}) == accepted);
  CHECK(refusal(plain_rig + "safe_output: {command_V: -5.5}\n") ==
        "rig.yaml:42: safe_output.command_V: found -5.5, expected at most +-valve.command_max_V (5)");
  CHECK(refusal(plain_rig + "evaluation: {from_s: 3, to_s: 3}\n") ==
        "rig.yaml:42: evaluation.from_s: found 3, expected less than evaluation.to_s (3)");
  CHECK(refusal(plain_rig + "evaluation: {from_s: 3, to_s: 6}\n") ==
        "rig.yaml:42: evaluation.to_s: found 6, expected at most duration_s (5)");
  CHECK(
      refusal(with(plain_rig, "duration_s: 5.0", "duration_s: 0.005"), {"period_s=0.01", "reference.amplitude_m=0"}) ==
      "--set period_s=0.01: duration_s: found 0.005, expected at least period_s (0.01)");
}

TEST_CASE("limits that no run can keep, or that allow for less than the config has, are refused") {
  CHECK(
      refusal(plain_rig, {"limits.deviation_m=5e-6"}) ==
      "--set limits.deviation_m=5e-6: limits.deviation_m: found 5.0e-06, expected more than the encoder's quantum and "
      "noise (5.0e-06), or nothing: it is derived");
  CHECK(refusal(plain_rig, {"limits.deviation_m=0"}) == accepted);
  CHECK(refusal(plain_rig, {"limits.dry_friction_max_N=10", "effects.coulomb_friction.force_N=12"}) ==
        "--set limits.dry_friction_max_N=10: limits.dry_friction_max_N: found 10, expected at least the dry "
        "friction of effects (12)");
  // The quantum of 100 Pa on both areas, 100 Pa sqrt(1.257^2 + 1.056^2) 1e-3 m2 = 0.16417 N, beside 12 N of friction.
  CHECK_THAT(refusal(plain_rig, {"limits.stall_force_N=12", "effects.coulomb_friction.force_N=12"}),
             Catch::Contains("limits.stall_force_N: found 12, expected more than dry friction and noise of the "
                             "pressures show at rest (12.16417"));
  CHECK_THAT(refusal(plain_rig, {"limits.stall_force_N=0.1641"}),
             Catch::Contains("limits.stall_force_N: found 0.1641"));
  CHECK(refusal(plain_rig, {"limits.stall_force_N=0.1642"}) == accepted);
  // 5 um a period of 1 ms, by a filter of 3 ms: 1 - exp(-1/3) of 5 mm/s, 1.417 mm/s.
  CHECK_THAT(refusal(plain_rig, {"limits.speed_deviation_mps=1.416e-3"}),
             Catch::Contains("limits.speed_deviation_mps: found 0.001416, expected more than the encoder's quantum and "
                             "noise give (0.001417"));
  CHECK(refusal(plain_rig, {"limits.speed_deviation_mps=1.418e-3"}) == accepted);
  CHECK_THAT(refusal(plain_rig, {"limits.pressure_Pa=7e5"}),
             Catch::Contains("limits.pressure_Pa: found 700000, expected more than supply.pressure_Pa (700000)"));
  CHECK_THAT(refusal(plain_rig, {"limits.age_periods=0.5", "simulation.input_age_periods=1"}),
             Catch::Contains("limits.age_periods: found 0.5, expected at least the age"));
}

TEST_CASE("an elastic load is a part of what moves") {
  CHECK(refusal(plain_rig, {"effects.elastic_load={mass_kg: 50, natural_frequency_Hz: 12, damping_ratio: 0.05}"})
            .find("effects.elastic_load.mass_kg: found 50, expected coupled loads of less than slider.mass_kg + "
                  "slider.payload_kg (2)") != std::string::npos);
  CHECK(refusal(plain_rig, {"effects.elastic_load={mass_kg: 1.2, natural_frequency_Hz: 12, damping_ratio: 0.05}",
                            "effects.load_backlash={mass_kg: 1.2, play_m: 0.001, contact_frequency_Hz: 60, "
                            "contact_damping_ratio: 0.1}"})
            .find("effects.load_backlash.mass_kg: found 1.2, expected coupled loads of less") != std::string::npos);
  CHECK(refusal(plain_rig, {"effects.supply_swing={amplitude_Pa: 900000, frequency_Hz: 2}"})
            .find("effects.supply_swing.amplitude_Pa: found 900000, expected at most") != std::string::npos);
  CHECK(refusal(plain_rig, {"effects.elastic_load={mass_kg: 1.0, natural_frequency_Hz: 12, damping_ratio: 0.05}"}) ==
        accepted);
}

TEST_CASE("a pass is refused where the reference is not known beforehand") {
  CHECK_THAT(
      refusal(with(with(plain_rig, "{kind: sine, amplitude_m: 0.080, frequency_Hz: 1.0}",
                        "{kind: live, lowest_m: -0.1, highest_m: 0.1, speed_mps: 0.3, acceleration_mps2: 3}"),
                   "kind: pd_force", "kind: pd_force\n  flow_feedforward: pass")),
      Catch::Contains("controller.flow_feedforward: found pass, expected off or formula with reference.kind live"));
}

TEST_CASE("the --set that makes two values contradict is named") {
  CHECK(refusal(plain_rig + "safe_output: {command_V: 2}\n", {"valve.command_max_V=1"}) ==
        "--set valve.command_max_V=1: safe_output.command_V: found 2, expected at most +-valve.command_max_V (1)");
  CHECK_THAT(refusal(plain_rig, {"cylinder.stroke_m=0.15"}),
             Catch::StartsWith("--set cylinder.stroke_m=0.15: reference: found the position "));
  CHECK_THAT(refusal(plain_rig, {"reference.amplitude_m=0.2"}),
             Catch::StartsWith("--set reference.amplitude_m=0.2: reference: "));
  CHECK(refusal(plain_rig + "evaluation: {from_s: 3, to_s: 5}\n", {"duration_s=4"}) ==
        "--set duration_s=4: evaluation.to_s: found 5, expected at most duration_s (4)");
}

TEST_CASE("chamber feedback needs chamber sensors") {
  CHECK(refusal(with(plain_rig, "estimated", "chamber")) ==
        "rig.yaml:35: controller.pressure_source: found 'chamber' without sensors.chamber_pressure, "
        "expected valve or estimated, or the section sensors.chamber_pressure");
  CHECK(refusal(with(plain_rig, "estimated", "chamber"), {"sensors.chamber_pressure={quantum_Pa: 100}"}) == accepted);
  CHECK(refusal(with(plain_rig, "estimated", "valve")) == accepted);
}

TEST_CASE("the initial state fits the stroke and the supply") {
  CHECK(refusal(plain_rig + "initial: {position_m: 0.16}\n") ==
        "rig.yaml:42: initial.position_m: found 0.16, expected at most +-half of cylinder.stroke_m (0.15)");
  CHECK(refusal(plain_rig + "initial: {pressure_1_Pa: 750000}\n") ==
        "rig.yaml:42: initial.pressure_1_Pa: found 750000, expected at most supply.pressure_Pa (700000)");
  CHECK(refusal(plain_rig + "initial: {pressure_1_Pa: 470000, pressure_2_Pa: 750000}\n") ==
        "rig.yaml:42: initial.pressure_2_Pa: found 750000, expected at most supply.pressure_Pa (700000)");
  CHECK_THAT(refusal(plain_rig + "initial: {pressure_1_Pa: 650000}\n"),
             Catch::StartsWith("rig.yaml:42: initial.pressure_1_Pa: found 650000, which 75") &&
                 Catch::Contains(", or pressure_2_Pa"));
  CHECK(refusal(plain_rig + "initial: {pressure_1_Pa: 650000, pressure_2_Pa: 700000}\n") == accepted);
}

TEST_CASE("initial pressures that nobody stated follow the supply") {
  CHECK(parse_rig(plain_rig, "rig.yaml").initial.pressure_1_Pa == 470000.0);
  const Rig low = parse_rig(plain_rig, "rig.yaml", {"supply.pressure_Pa=300000"});
  const double p1 = low.initial.pressure_1_Pa, atmosphere = 101325.0;
  const double p2 = atmosphere + 1.257e-3 / 1.056e-3 * (p1 - atmosphere);
  CHECK((p1 > atmosphere && p1 < 300000.0 && p2 < 300000.0));
}

TEST_CASE("references that leave the stroke are refused with place and time") {
  const std::string expected = ", expected positions within +-half of cylinder.stroke_m (0.15 m)";
  CHECK_THAT(refusal_of_reference("{kind: sine, amplitude_m: 0.16, frequency_Hz: 1}"),
             Catch::StartsWith("rig.yaml:40: reference: found the position ") && Catch::EndsWith(expected));
  CHECK_THAT(refusal_of_reference("{kind: sine, amplitude_m: 0.1, frequency_Hz: 1, center_m: -0.06}"),
             Catch::EndsWith(expected));
  CHECK(refusal_of_reference("{kind: sine, amplitude_m: 0.15, frequency_Hz: 1}") == accepted);
  CHECK(refusal_of_reference("{kind: waypoints, times_s: [0, 1, 2], positions_m: [0, 0.151, 0]}") ==
        "rig.yaml:40: reference: found the position 0.151 m at 1 s" + expected);
  CHECK_THAT(refusal_of_reference("{kind: cruise, start_m: 0, end_m: -0.2, speed_mps: 0.1, ramp_s: 0.1}"),
             Catch::EndsWith(expected));
  CHECK_THAT(refusal_of_reference("{kind: minimum_jerk, start_m: 0.155, end_m: 0, duration_s: 1}"),
             Catch::Contains("the position 0.155 m at 0 s"));
  CHECK_THAT(refusal_of_reference("{kind: multisine, components: [[0.1, 1, 0], [0.1, 1, 0.1]]}"),
             Catch::EndsWith(expected));
  // Components whose amplitudes add up beyond the stroke, but never at one time.
  CHECK(refusal_of_reference("{kind: multisine, components: [[0.1, 1, 0], [0.1, 1, 3.14159]]}") == accepted);
  // A sum whose parts go far at different times.
  CHECK(refusal_of_reference(
            "{kind: sum, parts: [{kind: waypoints, times_s: [0, 1, 2, 3], positions_m: [0, 0.14, 0.14, 0]}, "
            "{kind: sine, amplitude_m: 0.1, frequency_Hz: 1, start_s: 3}]}") == accepted);
  CHECK_THAT(refusal_of_reference("{kind: sum, parts: [{kind: waypoints, times_s: [0, 1], positions_m: [0, 0.14]}, "
                                  "{kind: sine, amplitude_m: 0.1, frequency_Hz: 1, start_s: 1}]}"),
             Catch::EndsWith(expected));
}

TEST_CASE("keys of references are checked against each other") {
  CHECK(refusal_of_reference("{kind: waypoints, times_s: [0, 1, 2], positions_m: [0, 0.1]}") ==
        "rig.yaml:40: reference.positions_m: found 2 positions, expected as many as times_s has (3)");
  CHECK(refusal_of_reference("{kind: waypoints, times_s: [0, 1, 1], positions_m: [0, 0.1, 0]}") ==
        "rig.yaml:40: reference.times_s: found 1 after 1, expected strictly increasing times");
  CHECK(refusal_of_reference("{kind: waypoints, times_s: [], positions_m: [0]}") ==
        "rig.yaml:40: reference.times_s: found an empty list, expected a list of numbers in s");
  CHECK(refusal_of_reference("{kind: waypoints, times_s: [0, one], positions_m: [0, 0.1]}") ==
        "rig.yaml:40: reference.times_s.1: found 'one', expected a number in s, 0 to 1000000");
  CHECK(refusal_of_reference("{kind: waypoints, times_s: [0, 1], positions_m: [0, 0.1], smoothness: 4}") ==
        "rig.yaml:40: reference.smoothness: found 4, expected one of 3, 5, 7, 9, 11");
  CHECK(refusal_of_reference("{kind: cruise, start_m: 0, end_m: 0.01, speed_mps: 0.1, ramp_s: 0.2}") ==
        "rig.yaml:40: reference.ramp_s: found 0.2, expected at most |end_m - start_m| / speed_mps (0.1 s), or the "
        "speed is never reached");
  CHECK(refusal_of_reference("{kind: multisine, components: [[0.1, 1]]}") ==
        "rig.yaml:40: reference.components.0: found a list of 2, expected [amplitude_m, frequency_Hz, phase_rad]");
  CHECK(refusal_of_reference("{kind: multisine, components: [[0.1, 0, 0]]}") ==
        "rig.yaml:40: reference.components.0.frequency_Hz: found 0, expected a number in Hz, 0.0001 to 50000");
  CHECK(refusal_of_reference("{kind: sine, amplitude_m: 0.1, frequency_Hz: 600}") ==
        "rig.yaml:40: reference: found 600 Hz, expected at most half a cycle a control period (500 Hz)");
  CHECK(refusal_of_reference("{kind: sine, amplitude_m: 0.1, frequency_Hz: 1, speed_mps: 1}")
            .find("reference.speed_mps: found an unknown key") != std::string::npos);
  CHECK(refusal_of_reference("{kind: sum, parts: [{kind: sine, amplitude_m: 0.1}]}") ==
        "rig.yaml:40: reference.parts.0.frequency_Hz: found nothing, expected a number in Hz, 0.0001 to 50000");
  CHECK(refusal_of_reference("{kind: sum, parts: [{kind: waypoints, times_s: [0, 1], positions_m: [0]}]}") ==
        "rig.yaml:40: reference.parts.0.positions_m: found 1 positions, expected as many as times_s has (2)");
  CHECK_THAT(refusal_of_reference("{kind: file, path: nowhere.csv}"),
             Catch::Contains("rig.yaml:40: reference.path: found no such file (") &&
                 Catch::Contains("nowhere.csv), expected a file of positions"));
}
