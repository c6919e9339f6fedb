// Diagnosis of a driven axis end to end: planted effects by name, clean machines, wrong parameters, what has no name.
#include <catch2/catch.hpp>

#include <algorithm>

#include "config/dump_rig.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/result_json.hpp"
#include "diagnosis/result_text.hpp"
#include "diagnosis/synthetic_axis.hpp"

using namespace pneuservo;
using namespace pneuservo::testing;

namespace {

struct Planted {
  std::string name;
  std::vector<std::pair<std::string, double>> values;  ///< config path and value
};

Rig with_values(Rig rig, const std::vector<std::pair<std::string, double>>& values) {
  for (const auto& [path, value] : values) set_parameter(rig, path, value);
  return rig;
}

/// A machine whose toleranced parameters are a little off, as every machine's are.
Rig scattered(Rig rig) {
  rig.axis.slider.mass_kg *= 1.01;
  rig.axis.slider.viscous_friction_Ns_per_m *= 0.95;
  return rig;
}

Diagnosis diagnosis_of(const Rig& machine) {
  return diagnose(driven_axis_rig(), {axis_recording(machine, 7, no_extra)});
}

double parameter(const DiagnosisAnswer& answer, const std::string& name) {
  for (const EstimatedParameter& p : answer.parameters)
    if (p.name == name) return p.value;
  FAIL("no parameter " << name);
  return 0;
}

}  // namespace

TEST_CASE("a planted effect on an axis is named with its size, and the improved config holds it") {
  const Planted planted = GENERATE(values<Planted>({
      {"coulomb_friction", {{"effects.coulomb_friction.force_N", 6}}},
      {"stribeck_friction",
       {{"effects.stribeck_friction.extra_force_N", 8},
        {"effects.stribeck_friction.velocity_mps", 0.02},
        {"effects.stribeck_friction.coulomb_force_N", 5}}},
      {"direction_dependent_friction",
       {{"effects.direction_dependent_friction.forward_N", 4},
        {"effects.direction_dependent_friction.backward_N", 11}}},
      {"friction_zone",
       {{"effects.friction_zone.force_N", 12},
        {"effects.friction_zone.center_m", 0.04},
        {"effects.friction_zone.width_m", 0.012}}},
      {"quadratic_drag", {{"effects.quadratic_drag.coefficient_Ns2_per_m2", 150}}},
      {"constant_force", {{"effects.constant_force.force_N", -5}}},
      {"spring_load", {{"effects.spring_load.stiffness_N_per_m", 150}, {"effects.spring_load.rest_m", 0.03}}},
      {"elastic_friction", {{"effects.elastic_friction.force_N", 8}, {"effects.elastic_friction.way_m", 3e-3}}},
      {"elastic_load",
       {{"effects.elastic_load.mass_kg", 3},
        {"effects.elastic_load.natural_frequency_Hz", 7},
        {"effects.elastic_load.damping_ratio", 0.04}}},
  }));
  INFO(planted.name);
  const Diagnosis found = diagnosis_of(with_values(scattered(driven_axis_rig()), planted.values));
  INFO(found.sentence);
  CHECK(found.verdict == Verdict::missing_physics);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers[0].effect == planted.name);
  CHECK(found.answers[0].element == "motion");
  CHECK(found.answers[0].probability > 0.5);
  for (const auto& [path, value] : planted.values) {
    const std::string key = path.substr(path.rfind('.') + 1);
    CHECK(parameter(found.answers[0], key) == Approx(value).epsilon(0.05));
    CHECK(get_parameter(found.improved, path) == Approx(value).epsilon(0.05));
  }
  CHECK(found.held_out_ratio < 0.8);
  CHECK_NOTHROW(parse_rig(dump_rig(found.improved), "improved"));
}

TEST_CASE("a clean axis is consistent, with the sizes that would have been seen") {
  const auto seed = GENERATE(1u, 2u, 3u, 4u, 5u);
  const Diagnosis found = diagnose(driven_axis_rig(), {axis_recording(scattered(driven_axis_rig()), seed, no_extra)});
  INFO(found.sentence);
  CHECK(found.verdict == Verdict::consistent);
  CHECK(found.answers.empty());
  const auto coulomb = std::find_if(found.detectable.begin(), found.detectable.end(),
                                    [](const DetectableSize& d) { return d.effect == "coulomb_friction"; });
  REQUIRE(coulomb != found.detectable.end());
  // What it says it would have seen is seen.
  const Diagnosis seen =
      diagnosis_of(with_values(driven_axis_rig(), {{"effects.coulomb_friction.force_N", coulomb->value}}));
  CHECK(seen.verdict == Verdict::missing_physics);
}

TEST_CASE("a mass off by ten tolerances is a parameter error with its value") {
  const Diagnosis found = diagnosis_of(with_values(driven_axis_rig(), {{"slider.mass_kg", 8.96}}));
  INFO(diagnosis_text(found));
  CHECK(found.verdict == Verdict::parameter_error);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers[0].effect == "parameter:slider.mass_kg");
  CHECK(parameter(found.answers[0], "value") == Approx(8.96).epsilon(0.003));
}

TEST_CASE("two effects at once are both named") {
  const Diagnosis found = diagnosis_of(with_values(
      driven_axis_rig(), {{"effects.spring_load.stiffness_N_per_m", 200}, {"effects.coulomb_friction.force_N", 6}}));
  INFO(found.sentence);
  REQUIRE(found.answers.size() == 2);
  std::vector<std::string> names{found.answers[0].effect, found.answers[1].effect};
  std::sort(names.begin(), names.end());
  CHECK(names == std::vector<std::string>{"coulomb_friction", "spring_load"});
}

TEST_CASE("a periodic force has no name: unknown at the motion, with its frequency") {
  const auto shaken = [](double t, double, double) { return 1.5 * std::sin(2 * M_PI * 9.3 * t); };
  const Diagnosis found = diagnose(driven_axis_rig(), {axis_recording(driven_axis_rig(), 3, shaken)});
  INFO(found.sentence);
  CHECK(found.verdict == Verdict::unknown);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers[0].effect == "unknown");
  CHECK(found.answers[0].element == "motion");
  CHECK(found.answers[0].note.find("9.3") != std::string::npos);
}

TEST_CASE("a load that is coupled with play is no law on an axis either: described, and unknown") {
  const Diagnosis found = diagnosis_of(with_values(
      scattered(driven_axis_rig()), {{"effects.load_backlash.mass_kg", 5}, {"effects.load_backlash.play_m", 2e-3}}));
  INFO(found.sentence);
  CHECK(found.verdict == Verdict::unknown);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers[0].element == "motion");
  CHECK(found.answers[0].note.find("load_backlash describes it") != std::string::npos);
}

TEST_CASE("a disturbance of the config is left out of a diagnosis, with a word") {
  Rig owner = driven_axis_rig();
  owner.axis.effects.motion.periodic_force = {5.0, 9.0, 0.0};
  const Diagnosis found = diagnose(owner, {axis_recording(driven_axis_rig(), 7, no_extra)});
  INFO(diagnosis_text(found));
  CHECK(found.verdict == Verdict::consistent);
  CHECK(std::count_if(found.warnings.begin(), found.warnings.end(), [](const std::string& warning) {
          return warning.find("effects.periodic_force of the config is left out") != std::string::npos;
        }) == 1);
}

TEST_CASE("the JSON has every key of the format") {
  const Diagnosis found = diagnosis_of(with_values(driven_axis_rig(), {{"effects.coulomb_friction.force_N", 6}}));
  const nlohmann::ordered_json json = diagnosis_json(found);
  CHECK(json["format"] == "pneuservo-diagnosis/1");
  CHECK(json["verdict"] == "missing_physics");
  CHECK(json["rig"] == "axis");
  CHECK(json["answers"][0]["parameters"]["force_N"]["value"].get<double>() == Approx(6).epsilon(0.05));
  CHECK(json["answers"][0]["parameters"]["force_N"]["standard_error"].get<double>() > 0);
  for (const char* key : {"recordings", "elements", "candidates", "data", "detectable"}) CHECK(json.contains(key));
  CHECK(json["next_experiment"].is_null());
  const auto& channel = json["fit"]["channels"]["F_N"];
  for (const char* key : {"noise", "before", "after", "held_out_before", "held_out_after"})
    CHECK(channel.contains(key));
  CHECK(channel["after"].get<double>() < channel["before"].get<double>());
  double shares = 0;
  for (const auto& e : json["elements"]) shares += e["share"].get<double>();
  CHECK(shares == Approx(1).epsilon(0.02));
}

TEST_CASE("the same recordings give the same answer, and a stop ends early with a word") {
  const Recording recording =
      axis_recording(with_values(driven_axis_rig(), {{"effects.coulomb_friction.force_N", 6}}), 1, no_extra);
  CHECK(diagnosis_json(diagnose(driven_axis_rig(), {recording})) ==
        diagnosis_json(diagnose(driven_axis_rig(), {recording})));
  int asked = 0;
  DiagnoseOptions options;
  options.stop = [&] { return ++asked > 12; };
  const Diagnosis stopped = diagnose(driven_axis_rig(), {recording}, options);
  CHECK(stopped.stopped);
  CHECK_FALSE(stopped.warnings.empty());
}
