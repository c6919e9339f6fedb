// The next experiment: its menu is safe, and a virtual run that faults gives no recording.
#include <catch2/catch.hpp>

#include <cmath>

#include "config/read_rig.hpp"
#include "diagnosis/verdict/safe_references.hpp"
#include "program/virtual_machine.hpp"

using namespace pneuservo;

namespace {

Rig owner_rig() {
  return read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-10m-6.10mm.yaml",
                  {"reference={kind: sine, amplitude_m: 0.02, frequency_Hz: 0.25}", "duration_s=9"});
}

}  // namespace

TEST_CASE("every reference of the menu stays within stroke, speed and force") {
  const Rig rig = owner_rig();
  const double speed = 0.4, half = 0.5 * rig.axis.cylinder.stroke_m;
  const auto menu = safe_references(rig, speed);
  REQUIRE(menu.size() >= 12);
  for (const ExperimentChoice& choice : menu) {
    const Reference reference(choice.reference);
    const auto place = reference.extremes(0, choice.duration_s), rate = reference.extremes(1, choice.duration_s),
               acceleration = reference.extremes(2, choice.duration_s);
    CAPTURE(&choice - menu.data(), place.minimum, place.maximum, rate.maximum, acceleration.maximum);
    REQUIRE(std::max(-place.minimum, place.maximum) < 0.9 * half);
    REQUIRE(std::max(-rate.minimum, rate.maximum) < 1.6 * speed);
    const double force = rig.axis.cylinder.area_2_m2 * (rig.axis.supply.pressure_Pa - rig.axis.air.atmosphere_Pa);
    REQUIRE(rig.axis.slider.mass_kg * std::max(-acceleration.minimum, acceleration.maximum) < 0.45 * force);
    REQUIRE(std::abs(reference.at(0.0).d[0]) < 1e-12);
  }
}

TEST_CASE("a fault ends a virtual run without a recording") {
  Rig rig = owner_rig();
  rig.limits.speed_mps = 1e-3;
  REQUIRE_FALSE(record_virtual_run(rig));
}
