// A rig that is written out and read back is the same rig; the manual page is what the program says today.
#include <catch2/catch.hpp>

#include <cstdlib>

#include "config/config_manual.hpp"
#include "config/dump_rig.hpp"
#include "config/read_rig.hpp"
#include "config/rig_parameters.hpp"
#include "config/same_rig.hpp"
#include "config/test_rigs.hpp"

using namespace pneuservo;
using test::plain_rig;
namespace fs = std::filesystem;

namespace {

void require_round_trip(const Rig& rig) {
  const std::string text = dump_rig(rig);
  INFO(text);
  const Rig again = parse_rig(text, "dump");
  REQUIRE(same_rig(rig, again));
  REQUIRE(dump_rig(again) == text);
}

}  // namespace

TEST_CASE("every config of the project comes back from its dump") {
  for (const fs::path& file : test::config_files()) {
    INFO(file);
    require_round_trip(read_rig(file));
  }
}

TEST_CASE("every rig of the shared data comes back from its dump") {
  const std::vector<fs::path> files = test::shared_rig_files();
  if (files.empty()) {
    WARN("SKIPPED: no shared data folder");
    return;
  }
  for (const fs::path& file : files) {
    INFO(file);
    require_round_trip(read_rig(file));
  }
}

TEST_CASE("every kind of reference comes back, in a dump and on one line") {
  const char* const nested =
      "{kind: sum, parts: [{kind: sine, amplitude_m: 0.01, frequency_Hz: 1}, {kind: sum, parts: [{kind: minimum_jerk, "
      "start_m: 0, end_m: 0.05, duration_s: 0.8}]}]}";
  for (const char* reference :
       {"{kind: sine, amplitude_m: 0.08, frequency_Hz: 1, ramp_s: 0, start_s: 0.1, smoothness: 11}",
        "{kind: multisine, components: [[0.01, 1.1, 0.1], [0.02, 0.7, -3]], center_m: 0.01}",
        "{kind: waypoints, times_s: [0, 0.1, 0.30000000000000004], positions_m: [0, 0.05, 0.05], smoothness: 7}",
        "{kind: cruise, start_m: -0.05, end_m: 0.05, speed_mps: 0.0597, ramp_s: 0.156, start_s: 0.2}",
        "{kind: minimum_jerk, start_m: -0.05, end_m: 0.05, duration_s: 0.8}", "{kind: file, path: '/dev/null'}",
        nested}) {
    INFO(reference);
    const Rig rig = parse_rig(plain_rig, "rig.yaml", {std::string("reference=") + reference});
    require_round_trip(rig);
    REQUIRE(same_reference(rig.reference, parse_reference(dump_reference(rig.reference), "line")));
  }
}

TEST_CASE("a rig with every effect, section and odd name comes back") {
  Rig rig =
      parse_rig(plain_rig, "rig.yaml",
                {"evaluation={from_s: 1, to_s: 2}", "initial.pressure_2_Pa=512345.678", "seed=18446744073709551615"});
  for (const ParameterPath& parameter : parameter_paths(rig))
    if (parameter.path.starts_with("effects."))
      set_parameter(rig, parameter.path,
                    parameter.value == 0.1 ? 0.2
                                           : std::max(0.1 * parameter.field.maximum / 3, parameter.field.minimum));
  visit_effects(rig, [](const Field&, auto& effect) {
    if constexpr (requires { effect.place; })  // points of a table ascend
      for (std::size_t i = 0; i < effect.place.size(); ++i) effect.place[i] = 0.1 * static_cast<double>(i + 1);
  });
  rig.axis.slider.mass_kg = 1000;      // loads on couplings are a part of it
  rig.reference.amplitude_m = 0.001;  // which the supply can move
  for (const char* name :
       {"null", "10", "a: b", "# x", "say \"yes\" \\ no", "Prüfstand", "~", "true", "-", "a/b.c-d_e"}) {
    rig.name = name;
    require_round_trip(rig);
  }
}

TEST_CASE("rigs that differ in one number are not the same") {
  const Rig original = parse_rig(plain_rig, "rig.yaml", {"tolerances.slider.mass_kg=0.1"});
  REQUIRE(same_rig(original, original));
  for (const ParameterPath& parameter : parameter_paths(original)) {
    INFO(parameter.path);
    Rig rig = original;
    set_parameter(rig, parameter.path,
                  parameter.value == parameter.field.maximum ? parameter.field.minimum : parameter.field.maximum);
    CHECK_FALSE(same_rig(rig, original));
  }
  Rig rig = original;
  rig.tolerances["slider.mass_kg"] = 0.2;
  CHECK_FALSE(same_rig(rig, original));
  rig = original;
  rig.controller.of<PdForce>().flow_feedforward = FeedforwardSource::formula;
  CHECK_FALSE(same_rig(rig, original));
}

TEST_CASE("the flow feedforward's older words read as today's") {
  const auto source = [](const std::string& word) {
    return parse_rig(plain_rig, "rig.yaml", {"controller.flow_feedforward=" + word})
        .controller.of<PdForce>()
        .flow_feedforward;
  };
  CHECK(source("false") == FeedforwardSource::off);
  CHECK(source("true") == FeedforwardSource::formula);
  CHECK(source("off") == FeedforwardSource::off);
  CHECK(source("formula") == FeedforwardSource::formula);
  CHECK(source("pass") == FeedforwardSource::pass);
}

TEST_CASE("the manual's example reads") {
  const Rig rig = parse_rig(config_example(), "example");
  CHECK(rig.axis.effects.motion.coulomb_friction.force_N == 3.0);
  CHECK(rig.tolerances.size() == 1);
}

TEST_CASE("docs/config-keys.md is what the program prints") {
  const std::string page = test::text_of(fs::path(PNEUSERVO_SOURCE_DIR) / "docs" / "config-keys.md");
  INFO("renew it with: pneuservo keys --markdown > docs/config-keys.md");
  REQUIRE(page == config_manual());
}

TEST_CASE("the manual names every key of a rig") {
  const std::string page = config_manual();
  for (const ParameterPath& parameter : parameter_paths(parse_rig(plain_rig, "rig.yaml"))) {
    INFO(parameter.path);
    const std::string key = parameter.path.substr(parameter.path.rfind('.') + 1);
    CHECK(page.find(key) != std::string::npos);
    CHECK(config_manual_text().find(key) != std::string::npos);
  }
}
