// Effects that a recording shows by themselves: each is named with its size, and where its name is not tried the
// verdict is `unknown` at its element.
#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

Rig vocabulary_rig() { return toleranced_cylinder_rig(2.0, 6.1e-3); }

Diagnosis diagnosed(const Rig& machine, const std::vector<std::string>& left_out = {}) {
  DiagnoseOptions options;
  options.left_out = left_out;
  return diagnose(vocabulary_rig(), {simulated_recording(machine, 6.5, 11, all_pressures)}, options);
}

double size_of(const DiagnosisAnswer& answer, const std::string& key) {
  for (const auto& parameter : answer.parameters)
    if (parameter.name == key) return parameter.value;
  return 0;
}

}  // namespace

TEST_CASE("a payload that is taken up is named, with mass, weight and instant, and without the name motion is unknown",
          "[optimised]") {
  Rig machine = vocabulary_rig();
  machine.axis.effects.motion.payload_change = {1.0, 9.81, 6.0 + 2.6};  // the axis has been held for 6 s before
  const Diagnosis found = diagnosed(machine);
  CAPTURE(found.sentence);
  CHECK(found.verdict == Verdict::missing_physics);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers.front().effect == "payload_change");
  CHECK(size_of(found.answers.front(), "mass_kg") == Approx(1.0).margin(0.4));
  CHECK(size_of(found.answers.front(), "weight_N") == Approx(9.81).epsilon(0.05));
  CHECK(size_of(found.answers.front(), "time_s") == Approx(2.6).margin(0.05));
  const Diagnosis ablated = diagnosed(machine, {"payload_change"});
  CAPTURE(ablated.sentence);
  CHECK(ablated.verdict == Verdict::unknown);
  CHECK(ablated.answers.front().element == "motion");
}

TEST_CASE("an underlap is named as edges that overlap by less than nothing", "[optimised]") {
  Rig machine = vocabulary_rig();
  machine.axis.effects.valve.valve_dead_band.width_V = -0.05;
  const Diagnosis found = diagnosed(machine);
  CAPTURE(found.sentence);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers.front().effect == "valve_dead_band");
  CHECK(size_of(found.answers.front(), "width_V") == Approx(-0.05).epsilon(0.05));
  CHECK(found.improved.axis.effects.valve.valve_dead_band.width_V == Approx(-0.05).epsilon(0.05));
}

TEST_CASE("a throttle with a check valve is named, and is no restriction both ways", "[optimised]") {
  Rig machine = vocabulary_rig();
  machine.axis.effects.flow_control_2.area_m2 = 4e-6;
  const Diagnosis found = diagnosed(machine);
  CAPTURE(found.sentence);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers.front().effect == "flow_control_2");
  CHECK(size_of(found.answers.front(), "area_m2") == Approx(4e-6).epsilon(0.1));
}

TEST_CASE("a relief valve is named, with its opening pressure", "[optimised]") {
  Rig machine = vocabulary_rig();
  machine.axis.effects.chamber_relief_2 = {3e-12, 560e3};
  const Diagnosis found = diagnosed(machine);
  CAPTURE(found.sentence);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers.front().effect == "chamber_relief_2");
  CHECK(size_of(found.answers.front(), "opening_Pa") == Approx(560e3).epsilon(0.05));
}
