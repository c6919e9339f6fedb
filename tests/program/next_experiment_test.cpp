// The next experiment: the menu is safe, and the recording made as proposed names the right one of two rivals.
#include <catch2/catch.hpp>

#include <cmath>

#include "config/read_rig.hpp"
#include "config/rig_parameters.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/safe_references.hpp"
#include "program/virtual_machine.hpp"

using namespace pneuservo;

namespace {

Rig owner_rig() {
  return read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-10m-6.10mm.yaml",
                  {"reference={kind: minimum_jerk, start_m: 0, end_m: 0.02, duration_s: 1.5}", "duration_s=4"});
}

Recording ports_only(Recording recording) {
  for (std::size_t c = recording.names.size(); c-- > 0;)
    if (recording.names[c].find("_chamber_") != std::string::npos || recording.names[c] == "p_supply_Pa") {
      recording.names.erase(recording.names.begin() + static_cast<std::ptrdiff_t>(c));
      recording.values.erase(recording.values.begin() + static_cast<std::ptrdiff_t>(c));
    }
  return recording;
}

Diagnosis diagnosis_of(const Rig& owner, const Rig& machine) {
  const auto recording = record_virtual_run(machine);
  REQUIRE(recording);
  DiagnoseOptions options;
  options.virtual_machine = record_virtual_run;
  return diagnose(owner, {ports_only(*recording)}, options);
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

TEST_CASE("the recording made as proposed names the right one of two rivals", "[long]") {
  const Rig owner = owner_rig();
  Rig machine = owner;
  set_parameter(machine, "effects.chamber_leak_1.area_m2", 3e-9);
  const Diagnosis first = diagnosis_of(owner, machine);
  INFO(first.sentence);
  REQUIRE(first.next_experiment);
  REQUIRE(first.next_experiment->separation >= least_separation);
  REQUIRE(first.next_experiment->between.size() >= 2);
  Rig proposed = experiment_rig(machine, *first.next_experiment);
  Rig believed = experiment_rig(owner, *first.next_experiment);
  const Diagnosis second = diagnosis_of(believed, proposed);
  INFO(second.sentence);
  REQUIRE_FALSE(second.answers.empty());
  REQUIRE(second.answers.front().effect == "chamber_leak_1");
  for (const std::string& rival : first.next_experiment->between)
    for (const std::string& left : second.answers.front().ambiguous_with) REQUIRE(left != rival);
}
