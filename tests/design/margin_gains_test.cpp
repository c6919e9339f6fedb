// The gains by margins keep them at every operating point, are the highest that do, and say what holds them back.
#include <catch2/catch.hpp>

#include <filesystem>

#include "config/read_rig.hpp"
#include "design/axis_design.hpp"
#include "design/margin_gains.hpp"

using namespace pneuservo;

namespace {

Rig rig_of(const std::string& name, const std::vector<std::string>& sets = {}) {
  return read_rig(std::filesystem::path(PNEUSERVO_SOURCE_DIR) / "config" / (name + ".yaml"), sets);
}

AxisDesign judged(const Rig& rig, const MarginGains& gains, double position_m, double payload_kg, double higher = 1.0) {
  Rig at = with_margin_gains(rig, gains);
  at.controller.of<PdForce>().force_gain_V_per_N *= higher;
  at.initial.position_m = position_m;
  at.axis.slider.payload_kg = payload_kg;
  return design_axis(at, {});
}

}  // namespace

TEST_CASE("gains by margins keep them over stroke and payload on distributed lines") {
  for (const char* name : {"cylinder-2m-4.15mm", "cylinder-10m-7.65mm"}) {
    const Rig rig = rig_of(name);
    const auto gains = highest_gains(rig);
    REQUIRE(gains);
    double least_up = infinite, least_phase = infinite;
    for (const double place : {-0.15, -0.1, 0.0, 0.1, 0.15})
      for (const double payload_kg : {0.0, *rig.limits.payload_max_kg}) {
        const AxisDesign design = judged(rig, *gains, place, payload_kg);
        INFO(name << " at " << place << " m with " << payload_kg << " kg");
        // The margins of the verb's own scan, by other code, between the search's operating points too.
        CHECK(design.exact_margins.gain_up >= 0.97 * least_gain_margin);
        CHECK(design.exact_margins.gain_down <= 1.03 / least_gain_margin);
        CHECK(design.exact_margins.phase_deg >= least_phase_margin_deg - 1.0);
        CHECK(design.is_stable);
        least_up = std::min(least_up, design.exact_margins.gain_up);
        least_phase = std::min(least_phase, design.exact_margins.phase_deg);
      }
    // At least one of the two is used up: no gain is given away.
    INFO(name << ": gain margin " << least_up << ", phase margin " << least_phase << " deg");
    CHECK((least_up < 1.15 * least_gain_margin || least_phase < least_phase_margin_deg + 4.0));
  }
}

TEST_CASE("shorter lines and less payload allow stiffer gains, and the obstacle says so") {
  const Rig rig = rig_of("cylinder-10m-4.15mm");
  const auto gains = highest_gains(rig);
  REQUIRE(gains);
  const Rig shorter = rig_of("cylinder-10m-4.15mm", {"line_1.length_m=5", "line_2.length_m=5"});
  CHECK(highest_gains(shorter)->error_m < gains->error_m);
  CHECK_THAT(obstacle_words(rig, gains), Catch::Contains("half the length of both lines (10 and 10 m)"));
}

TEST_CASE("other laws and rigs have no gains by margins") {
  CHECK_THROWS_WITH(highest_gains(rig_of("servo-table-2m-4mm")), Catch::Contains("expected rig: cylinder"));
}
