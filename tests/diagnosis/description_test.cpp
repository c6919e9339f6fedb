// Physics that has no law in the vocabulary, but a place and a shape: the verdict is `unknown` there and tells the
// shape.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "core/run_length.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

/// What the recording would be had the valve's edges the area k |u/u_0|^exponent u: the command that this valve needs
/// for what the straight one did.
Recording through_power_law(Recording recording, double exponent, double u_0) {
  const auto column = std::find(recording.names.begin(), recording.names.end(), "u_V") - recording.names.begin();
  for (double& u : recording.values[static_cast<std::size_t>(column)])
    u = std::copysign(u_0 * std::pow(std::fabs(u) / u_0, 1 / (1 + exponent)), u);
  return recording;
}

const ChannelFit& channel(const Diagnosis& found, const std::string& column) {
  return *std::find_if(found.channels.begin(), found.channels.end(),
                       [&](const ChannelFit& c) { return c.column == column; });
}

void check_described(const Diagnosis& found, const std::string& element, const std::string& description) {
  CAPTURE(found.sentence);
  CHECK(found.verdict == Verdict::unknown);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers.front().element == element);
  REQUIRE(!found.elements.empty());
  CHECK(found.elements.front().element == element);
  CHECK(found.answers.front().note.find(description + " describes it") != std::string::npos);
  for (const char* port : {"p1_port_Pa", "p2_port_Pa"})
    CHECK(channel(found, port).held_out_after < 0.3 * channel(found, port).held_out_before);
}

}  // namespace

TEST_CASE("a leak past the piston about one place is told with its place, and is no leak of the whole piston",
          "[long]") {
  const Rig owner = toleranced_cylinder_rig(5.0, 6.1e-3);
  Rig machine = owner;
  const double width_m = GENERATE(from_range(and_in_the_long_run({0.02}, {0.01})));
  CAPTURE(width_m);
  machine.axis.effects.piston_leak_zone = {8e-8, -0.04, width_m};
  const Diagnosis found = diagnose(owner, {simulated_recording(machine, 6.5, 31, all_pressures)});
  check_described(found, "piston", "piston_leak_zone");
  const PistonLeakZone<double>& zone = found.improved.axis.effects.piston_leak_zone;
  CHECK(zone.center_m == Approx(-0.04).margin(2e-3));
  // What passes in all is known better than how narrow the place is.
  CHECK(zone.area_m2 * zone.width_m == Approx(8e-8 * width_m).epsilon(0.1));
  CHECK(zone.width_m == Approx(width_m).epsilon(0.25));
}

TEST_CASE("a supply whose pressure swings is located there with its frequency, measured or not") {
  const Rig owner = toleranced_cylinder_rig(5.0, 6.1e-3);
  std::vector<std::string> channels{"p1_port_Pa", "p2_port_Pa"};
  const bool is_measured = GENERATE(false, true);
  if (is_measured) channels.emplace_back("p_supply_Pa");
  CAPTURE(is_measured);
  Rig machine = owner;
  machine.axis.effects.supply_swing = {30e3, 3.7, 0.4};
  std::vector<Recording> recordings{simulated_recording(machine, 5.0, 34, channels)};
  machine.axis.effects.supply_swing.phase_rad = 2.0;
  if (is_measured) recordings.push_back(simulated_recording(machine, 5.0, 35, channels));
  const Diagnosis found = diagnose(owner, recordings);
  CAPTURE(found.sentence);
  CHECK(found.verdict == Verdict::unknown);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers.front().element == "supply");
  const std::string& note = found.answers.front().note;
  // The model that knows what the supply does leaves it in the channel of its sensor.
  CHECK(note.find(is_measured ? "Hz in p_supply" : "a supply pressure that swings by") != std::string::npos);
  CHECK((note.find("at 3.7") != std::string::npos || note.find("at 3.6") != std::string::npos));
}

TEST_CASE("a leak of the whole piston keeps its name") {
  const Rig owner = toleranced_cylinder_rig(5.0, 6.1e-3);
  Rig machine = owner;
  machine.axis.effects.piston_leak.area_m2 = 3e-8;
  const Diagnosis found = diagnose(owner, {simulated_recording(machine, 6.5, 32, all_pressures)});
  CAPTURE(found.sentence);
  CHECK(found.verdict == Verdict::missing_physics);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers.front().effect == "piston_leak");
}

TEST_CASE("edges that follow a power of the command sit at the valve, whatever law two names make of them", "[long]") {
  const Rig owner = toleranced_cylinder_rig(5.0, 6.1e-3);
  const double exponent = GENERATE(from_range(and_in_the_long_run({0.1}, {-0.1})));
  CAPTURE(exponent);
  const Recording plain = simulated_recording(owner, 9.0, 33, all_pressures);
  const Diagnosis found = diagnose(owner, {through_power_law(plain, exponent, 1.0)});
  check_described(found, "valve", "valve_curve");
  // A power below one opens early: the slope is larger about the middle.
  const ValveCurve<double>& curve = found.improved.axis.effects.valve.valve_curve;
  const double early = curve.factor(0.1, 5.0), late = curve.factor(1.5, 5.0);
  CHECK((early - late) * exponent < 0);
}
