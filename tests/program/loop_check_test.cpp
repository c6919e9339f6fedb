// The loop of a config is judged by its margins and in simulation before it moves anything.
#include <catch2/catch.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <pneuservo/core/random.hpp>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "core/test_seed.hpp"
#include "program/loop_check.hpp"

using namespace pneuservo;

namespace {

Rig cylinder(const std::vector<std::string>& sets = {}, const std::string& lines = "10m-7.65mm") {
  return read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/cylinder-" + lines + ".yaml", sets);
}

FindingLevel level_of(const std::vector<Finding>& findings, const std::string& topic) {
  const auto found =
      std::find_if(findings.begin(), findings.end(), [&](auto& finding) { return finding.topic == topic; });
  REQUIRE(found != findings.end());
  if (found->level != FindingLevel::good) CHECK_FALSE(found->remedy.empty());
  return found->level;
}

}  // namespace

TEST_CASE("a loop with its gains as tuned is not unsafe, and follows or lags") {
  for (const char* lines : {"10m-7.65mm", "2m-7.65mm"}) {
    const auto findings = grade_loop(cylinder({}, lines));
    INFO(lines << "\n" << finding_table(findings));
    CHECK(worst_level(findings) < FindingLevel::bad);
  }
}

TEST_CASE("drawn gains and payloads that make the loop unstable are unsafe, at the payload that does it") {
  const unsigned seed = test::new_seed();
  Random random(seed);
  for (int i = 0; i < 3; ++i) {
    const double times = random.uniform(5.0, 70.0);
    const std::string gain = fmt::format("controller.force_gain_V_per_N={}", 0.00572 * times);
    const auto findings = grade_loop(cylinder({gain}));
    INFO("seed " << seed << ", " << gain << "\n" << finding_table(findings));
    CHECK(level_of(findings, "loop margins") == FindingLevel::unsafe);
    CHECK(level_of(findings, "loop at rest") == FindingLevel::unsafe);
    CHECK_FALSE(unstable_loop_words(cylinder({gain})).empty());
  }
  const std::string most = fmt::format("limits.payload_max_kg={}", random.uniform(6.0, 15.0));
  const Rig carrying = cylinder({"slider.viscous_friction_Ns_per_m=10", most});
  const auto findings = grade_loop(carrying);
  INFO(most << "\n" << finding_table(findings));
  CHECK(level_of(findings, "loop margins") == FindingLevel::unsafe);
  CHECK_THAT(unstable_loop_words(carrying), Catch::Contains("payload"));
}

TEST_CASE("an axis on devices does not start with an unsafe loop, unless that is allowed") {
  const Rig unstable = cylinder({"controller.position_gain_N_per_m=75500"});
  CHECK_THROWS_AS(heed_loop("rig.yaml", unstable, true, {}), InputError);
  CHECK_NOTHROW(heed_loop("rig.yaml", unstable, true, {.unstable_loop = true}));
  CHECK_NOTHROW(heed_loop("rig.yaml", cylinder(), true, {}));
  CHECK_NOTHROW(heed_loop("rig.yaml", unstable, false, {}));
  CHECK_THROWS_WITH(heed_loop("rig.yaml", cylinder({"limits.deviation_m=0"}), true, {.unstable_loop = true}),
                    Catch::Contains("limits.deviation_m"));
}

TEST_CASE("a reference that the loop cannot follow is bad") {
  const auto findings = grade_loop(cylinder({"reference.frequency_Hz=4", "reference.amplitude_m=0.04"}));
  INFO(finding_table(findings));
  CHECK(level_of(findings, "loop in motion") >= FindingLevel::bad);
}

TEST_CASE("check states every limit of the supervised motion, and which unknown payload they find") {
  const auto what_of = [](const std::vector<Finding>& findings, const std::string& topic) {
    const auto found = std::find_if(findings.begin(), findings.end(), [&](auto& one) { return one.topic == topic; });
    REQUIRE(found != findings.end());
    return found->what;
  };
  const unsigned seed = test::new_seed();
  Random random(seed);
  const double limit = std::round(1e3 * random.uniform(0.3, 0.5)) / 1e3;
  const auto derived = grade_loop(cylinder());
  const auto stated = grade_loop(cylinder({fmt::format("limits.speed_deviation_mps={}", limit)}));
  INFO("seed " << seed << "\n" << finding_table(stated));
  CHECK_THAT(what_of(stated, "motion limits"), Catch::Contains(fmt::format("of the speed {} m/s", limit)));
  CHECK(what_of(stated, "motion limits") != what_of(derived, "motion limits"));
  CHECK_THAT(what_of(derived, "unknown payload"),
             Catch::Contains("payload of 2") && Catch::Contains("cannot be told") && Catch::Contains("200 kg after "));
  const auto blind =
      grade_loop(cylinder({"limits.deviation_m=0", "limits.speed_deviation_mps=0", "limits.speed_mps=100",
                           "limits.stall_force_N=0", "limits.end_stop_contact=allowed"}));
  INFO(finding_table(blind));
  CHECK(level_of(blind, "unknown payload") == FindingLevel::acceptable);
  CHECK_THAT(what_of(blind, "unknown payload"), Catch::Contains("100, 200 kg cannot be told"));
}
