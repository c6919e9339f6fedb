// Recordings of a machine that its owner changed between them: each is compared with the rig as it was, and rivals that
// one supply pressure cannot tell apart are told apart by two.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "config/input_error.hpp"
#include "config/rig_parameters.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/recordings/recorded_rigs.hpp"
#include "diagnosis/residuals/cylinder_residuals.hpp"
#include "diagnosis/residuals/driven_axis_residuals.hpp"
#include "diagnosis/simulated_recording.hpp"
#include "diagnosis/synthetic_axis.hpp"

using namespace pneuservo;
using test::all_pressures;
using test::cylinder_rig;
using test::simulated_recording;

namespace {

constexpr double lower_supply_Pa = 525e3;

Rig with(Rig rig, const std::string& path, double value) {
  set_parameter(rig, path, value);
  return rig;
}

std::string refusal_of(const std::string& path, double value, int times = 1) {
  Recording recording;
  recording.path = "slow.csv.gz";
  for (int i = 0; i < times; ++i) recording.changed.emplace_back(path, value);
  try {
    machine_changes(cylinder_rig(), recording);
  } catch (const InputError& error) { return error.what(); }
  return "accepted";
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

TEST_CASE("a changed number keeps its deviation as a share, a load comes on top") {
  Recording recording;
  recording.changed = {{"supply.pressure_Pa", lower_supply_Pa}, {"slider.payload_kg", 1.5}};
  const MachineChanges changes = machine_changes(cylinder_rig(), recording);
  const Rig off = with(with(cylinder_rig(), "supply.pressure_Pa", 714e3), "slider.payload_kg", 0.1);
  const Rig changed = changed_rig(off, changes);
  CHECK(changed.axis.supply.pressure_Pa == Approx(1.02 * lower_supply_Pa));
  CHECK(changed.axis.slider.payload_kg == Approx(1.6));
  CHECK(changed.axis.slider.mass_kg == off.axis.slider.mass_kg);
}

TEST_CASE("a change that the rig cannot have is refused with recording, key and what was expected") {
  CHECK(refusal_of("supply.pressure_Pa", 1e12).starts_with("slow.csv.gz: changed for it: "));
  CHECK(refusal_of("supply.pressure_Pa", 1e12).find("supply.pressure_Pa") != std::string::npos);
  CHECK(refusal_of("supply.presure_Pa", 5e5).find("did you mean supply.pressure_Pa") != std::string::npos);
  CHECK(refusal_of("sensors.position.noise_m", 1e-6).find("expected a number of air, supply") != std::string::npos);
  CHECK(refusal_of("cylinder.area_1_m2", 1e-3).find("expected a number of air, supply") != std::string::npos);
  CHECK(refusal_of("supply.pressure_Pa", lower_supply_Pa, 2).find("supply.pressure_Pa twice") != std::string::npos);
  CHECK(refusal_of("supply.pressure_Pa", lower_supply_Pa) == "accepted");
}

TEST_CASE("beside others a changed recording is simulated as with a config of its own, also for a rig that is off") {
  // A line of a sixth the length needs shorter steps than the owner's.
  const auto [path, value] = GENERATE(table<std::string, double>(
      {{"supply.pressure_Pa", lower_supply_Pa}, {"line_1.length_m", 0.5}, {"line_2.diameter_m", 4e-3}}));
  CAPTURE(path);
  const Rig owner = cylinder_rig(3.0), changed = with(owner, path, value);
  const Recording first = simulated_recording(owner, 3.0, 1, all_pressures);
  Recording second = simulated_recording(changed, 3.0, 2, all_pressures);
  CylinderResiduals alone(changed, {second});
  second.changed = {{path, value}};
  CylinderResiduals both(owner, {first, second});
  const double share = GENERATE(1.0, 1.03);
  const auto here = both.courses({with(owner, path, share * get_parameter(owner, path)), {}});
  const auto there = alone.courses({with(changed, path, share * value), {}});
  REQUIRE(here.size() == 2 * there.size());
  for (const ResidualCourse& wanted : there) {
    const auto found = std::find_if(here.begin(), here.end(), [&](const ResidualCourse& course) {
      return course.recording == 1 && course.channel == wanted.channel;
    });
    REQUIRE(found != here.end());
    CAPTURE(both.channels()[static_cast<std::size_t>(wanted.channel)].name);
    if (both.channels()[static_cast<std::size_t>(wanted.channel)].name != "F") {  // which knows rest by all noises
      CHECK(largest_difference(found->simulated, wanted.simulated) < 1e-3);  // Pa: a factor of the number rounds
      CHECK(found->measured == wanted.measured);
    }
  }
}

TEST_CASE("a driven axis with a known load is compared with the load") {
  using namespace pneuservo::testing;
  const Rig owner = driven_axis_rig(), loaded = with(owner, "slider.payload_kg", 4.0);
  Recording recording = axis_recording(loaded, 3, no_extra);
  DrivenAxisResiduals alone(loaded, {recording}), forgotten(owner, {recording});
  recording.changed = {{"slider.payload_kg", 4.0}};
  DrivenAxisResiduals told(owner, {recording});
  const auto misfit_of = [](DrivenAxisResiduals& model, const Rig& rig) {
    return model.sample_misfit({rig, {}}).front().fitted;
  };
  CHECK(misfit_of(told, owner) == Approx(misfit_of(alone, loaded)).epsilon(0.02));  // what counts as rest differs
  CHECK(misfit_of(forgotten, owner) > 5 * misfit_of(told, owner));
}

TEST_CASE("dry and pressure-dependent friction, alike at one supply pressure, are told apart by two") {
  Rig owner = cylinder_rig(2.0);
  owner.tolerances = {
      {"slider.mass_kg", 0.02}, {"slider.viscous_friction_Ns_per_m", 0.1}, {"cylinder.area_1_m2", 0.005}};
  const Rig machine = with(owner, "effects.coulomb_friction.force_N", 0.8);
  const Recording first = simulated_recording(machine, 8.0, 5, all_pressures);
  Recording second = simulated_recording(with(machine, "supply.pressure_Pa", 400e3), 8.0, 6, all_pressures);
  const Diagnosis one = diagnose(owner, {first});
  REQUIRE(one.answers.size() == 1);
  const bool is_ambiguous = one.answers[0].effect == "pressure_dependent_friction" ||
                            holds(one.answers[0].ambiguous_with, "pressure_dependent_friction");
  CHECK(is_ambiguous);

  second.changed = {{"supply.pressure_Pa", 400e3}};
  const Diagnosis two = diagnose(owner, {first, second});
  CAPTURE(two.sentence);
  REQUIRE(two.answers.size() == 1);
  CHECK(two.answers[0].effect == "coulomb_friction");
  CHECK_FALSE(holds(two.answers[0].ambiguous_with, "pressure_dependent_friction"));
  CHECK(two.answers[0].parameters.at(0).value == Approx(0.8).epsilon(0.1));
  CHECK(std::any_of(two.warnings.begin(), two.warnings.end(), [](const std::string& warning) {
    return warning.find("made with supply.pressure_Pa = 400000 instead of 700000") != std::string::npos;
  }));
}
