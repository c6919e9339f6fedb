// Names for what comes late between command and spool: a dead time has a valley every sample, and what is too small to
// be named elsewhere is not called something else where it is seen.
#include <tuple>
#include <vector>

#include <catch2/catch.hpp>

#include "core/run_length.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

Diagnosis diagnosis_of(const Rig& machine, const Rig& owner, const std::vector<std::string>& channels) {
  return diagnose(owner, {simulated_recording(machine, 7.0, 11, channels)});
}

}  // namespace

TEST_CASE("late command: a dead time of many samples is none of the lags of its length", "[long]") {
  const double delay_s = GENERATE(from_range(and_in_the_long_run({8e-3}, {4e-3})));
  const Rig owner = toleranced_cylinder_rig(10.0, 4.15e-3);
  Rig machine = owner;
  machine.axis.line_1.length_m *= 1.004;
  machine.axis.effects.valve.command_delay.delay_s = delay_s;
  const Diagnosis diagnosis = diagnosis_of(machine, owner, {"p1_port_Pa", "p2_port_Pa"});
  CAPTURE(diagnosis.sentence);
  REQUIRE(diagnosis.answers.size() == 1);
  CHECK(diagnosis.answers[0].effect == "command_delay");
  CHECK(diagnosis.answers[0].parameters.at(0).value == Approx(delay_s).margin(0.25e-3));
}

TEST_CASE("late command: a dead time is found where the command's noise has no slope towards it", "[long]") {
  using Line = std::tuple<double, double, double, double>;
  const std::vector<Line> lines =
      and_in_the_long_run<Line>({{10.0, 4.15e-3, 1.25e-3, 5e-3}}, {{5.0, 6.1e-3, 2e-3, 3e-3}});
  const auto [length_m, diameter_m, force_gain_V_per_N, delay_s] = GENERATE_COPY(from_range(lines));
  CAPTURE(length_m, force_gain_V_per_N, delay_s);
  Rig owner = toleranced_cylinder_rig(length_m, diameter_m);
  owner.axis.slider.payload_kg = 1.25;
  Rig machine = owner;
  machine.axis.effects.valve.command_delay.delay_s = delay_s;
  machine.axis.supply.pressure_Pa *= 0.995;
  const std::vector<std::string> channels{"p1_port_Pa", "p2_port_Pa", "p_supply_Pa"};
  const Diagnosis diagnosis =
      diagnose(owner, {simulated_recording(machine, 7.0, 11, channels, 1.0, force_gain_V_per_N)});
  CAPTURE(diagnosis.sentence);
  REQUIRE(diagnosis.answers.size() == 1);
  CHECK(diagnosis.answers[0].effect == "command_delay");
  const EstimatedParameter& found = diagnosis.answers[0].parameters.at(0);
  CHECK(found.value == Approx(delay_s).margin(2 * found.standard_error));
  CHECK(found.standard_error < 0.4 * owner.period_s);
}

TEST_CASE("late command: a lag of less than half a sample that is seen is called late, and no hysteresis") {
  Rig owner = toleranced_cylinder_rig(2.0, 6.1e-3);
  owner.axis.valve.natural_frequency_Hz = 120;
  owner.axis.valve.damping_ratio = 0.7;
  Rig machine = owner;
  machine.axis.effects.valve.valve_lag.time_constant_s = 0.42e-3;
  const Diagnosis diagnosis = diagnosis_of(machine, owner, all_pressures);
  CAPTURE(diagnosis.sentence);
  const std::string name = diagnosis.answers.empty() ? "nothing is missing" : diagnosis.answers[0].effect;
  CHECK((name == "nothing is missing" || name == "valve_lag" || name == "command_delay"));
}
