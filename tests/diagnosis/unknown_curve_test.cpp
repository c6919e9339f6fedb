// Physics that no list has, drawn as a table: the verdict is `unknown` at its element, the table is what was hidden,
// and held-out stretches fit.
#include <catch2/catch.hpp>

#include <cmath>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

Diagnosis diagnosed_with_curve(const Rig& machine, const std::vector<std::string>& left_out = {}) {
  DiagnoseOptions options;
  options.left_out = left_out;
  options.with_curve = true;
  return diagnose(toleranced_cylinder_rig(2.0, 6.1e-3), {simulated_recording(machine, 6.5, 11, all_pressures)},
                  options);
}

double curve_at(const UnknownCurve& curve, double place) {
  PointTable<double> table;
  REQUIRE(curve.points.size() == PointTable<double>::points);
  for (std::size_t i = 0; i < curve.points.size(); ++i)
    table.place[i] = curve.points[i].place, table.value[i] = curve.points[i].value;
  return table.at(place);
}

const ChannelFit& channel_of(const UnknownCurve& curve, const std::string& column) {
  for (const ChannelFit& one : curve.channels)
    if (one.column == column) return one;
  FAIL("no channel " << column);
  return curve.channels.front();
}

}  // namespace

TEST_CASE("a load that no law draws is drawn over position, in the improved config too", "[optimised]") {
  Rig machine = toleranced_cylinder_rig(2.0, 6.1e-3);
  // A rubber bumper from -60 mm on, and a cam in the middle.
  machine.axis.effects.motion.force_over_position.place = {-0.105, -0.09, -0.075, -0.06, -0.045, -0.03, -0.015, 0.0};
  machine.axis.effects.motion.force_over_position.value = {-30, -14, -4, 0, 9, 9, 0, 0};
  const Diagnosis found = diagnosed_with_curve(machine);
  CAPTURE(found.sentence);
  REQUIRE(found.verdict == Verdict::unknown);
  CHECK(found.answers.front().element == "motion");
  REQUIRE(found.curve.has_value());
  CHECK(found.curve->effects == std::vector<std::string>{"force_over_position"});
  CHECK(curve_at(*found.curve, -0.098) == Approx(-22).margin(3));
  CHECK(curve_at(*found.curve, -0.0375) == Approx(9).margin(2));
  CHECK(curve_at(*found.curve, -0.002) == Approx(0).margin(2));
  const ChannelFit& force = channel_of(*found.curve, "F_N");
  CHECK(force.held_out_after < 0.25 * force.held_out_before);
  CHECK(found.improved.axis.effects.motion.force_over_position.is_there());
}

TEST_CASE("a leak that opens above a pressure is drawn over it where it has no name", "[optimised]") {
  Rig machine = toleranced_cylinder_rig(2.0, 6.1e-3);
  machine.axis.effects.chamber_relief_2 = {3e-12, 560e3};
  const Diagnosis found = diagnosed_with_curve(machine, {"chamber_relief_2", "chamber_relief_1"});
  CAPTURE(found.sentence);
  REQUIRE(found.verdict == Verdict::unknown);
  REQUIRE(found.curve.has_value());
  CHECK(found.curve->effects == std::vector<std::string>{"leak_over_pressure_2"});
  CHECK(curve_at(*found.curve, 555e3) < 3e-9);
  CHECK(curve_at(*found.curve, 565e3) == Approx(1.5e-8).epsilon(0.2));
  const ChannelFit& port = channel_of(*found.curve, "p2_port_Pa");
  CHECK(port.held_out_after < 0.5 * port.held_out_before);
}

TEST_CASE("without an unknown there is no curve", "[optimised]") {
  Rig machine = toleranced_cylinder_rig(2.0, 6.1e-3);
  machine.axis.effects.motion.coulomb_friction.force_N = 12.0;
  const Diagnosis found = diagnosed_with_curve(machine);
  CAPTURE(found.sentence);
  CHECK(found.verdict == Verdict::missing_physics);
  CHECK_FALSE(found.curve.has_value());
}
