// What a config leaves out of its supervision: each limit that never acts and each line that is missing is named.
#include <catch2/catch.hpp>

#include <algorithm>

#include "config/read_rig.hpp"
#include "loop/safety_grade.hpp"

using namespace pneuservo;

namespace {

std::vector<Finding> graded(const std::string& config, const std::vector<std::string>& sets = {}) {
  return grade_safety(read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/" + config, sets), {});
}

const std::string cylinder = "cylinder-10m-7.65mm.yaml", on_devices = "can/cylinder-10m-7.65mm.yaml";

FindingLevel level_of(const std::vector<Finding>& findings, const std::string& topic) {
  const auto found =
      std::find_if(findings.begin(), findings.end(), [&](const Finding& finding) { return finding.topic == topic; });
  INFO(topic << " in\n" << finding_table(findings));
  REQUIRE(found != findings.end());
  if (found->level != FindingLevel::good) CHECK_FALSE(found->remedy.empty());
  return found->level;
}

}  // namespace

TEST_CASE("a config with its usual limits has no unsafe one") {
  for (const char* config : {"cylinder-10m-7.65mm.yaml", "cylinder-2m-4.15mm.yaml", "servo-table-1m-8mm.yaml"}) {
    INFO(config << "\n" << finding_table(graded(config)));
    CHECK(worst_level(graded(config)) < FindingLevel::bad);
  }
}

TEST_CASE("every limit that is switched off is unsafe and named") {
  const auto [set, key] = GENERATE(table<std::string, std::string>({
      {"limits.speed_mps=100", "speed_mps"},
      {"limits.speed_mps=40", "speed_mps"},
      {"limits.deviation_m=0", "deviation_m"},
      {"limits.deviation_m=0.5", "deviation_m"},
      {"limits.stall_force_N=0", "stall_force_N"},
      {"limits.stall_force_N=2000", "stall_force_N"},
      {"limits.end_stop_contact=allowed", "end_stop_contact"},
      {"limits.position_margin_m=1", "position_margin_m"},
      {"limits.lateness_s=3600", "lateness_s"},
      {"limits.age_periods=1000", "age_periods"},
      {"limits.checks_rest_s=0", "checks_rest_s"},
      {"limits.bad_share=1", "bad_share"},
      {"limits.missed_share=1", "missed_share"},
      {"limits.flow_mismatch_share=0", "flow_mismatch_share"},
      {"limits.flow_mismatch_share=8", "flow_mismatch_share"},
      {"limits.chamber_mismatch_Pa=0", "chamber_mismatch_Pa"},
      {"limits.chamber_mismatch_Pa=1e6", "chamber_mismatch_Pa"},
      {"limits.supply_share=0", "supply_share"},
      {"limits.pressure_Pa=1e8", "pressure_Pa"},
  }));
  const auto findings = graded(cylinder, {set});
  CHECK(level_of(findings, "limits." + key) == FindingLevel::unsafe);
  CHECK(std::count_if(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.level >= FindingLevel::bad; }) == 1);
}

TEST_CASE("a late limit is told with the way that it lets the axis go") {
  // Twice the reference's peak speed, 2 pi 0.08 m/s, for 0.1 s.
  const auto usual = graded(cylinder);
  const auto found = std::find_if(usual.begin(), usual.end(), [](auto& f) { return f.topic == "limits.lateness_s"; });
  REQUIRE(found != usual.end());
  CHECK_THAT(found->what, Catch::Contains("101 mm at 1.01 m/s"));
  CHECK(level_of(graded(cylinder, {"limits.lateness_s=0.02"}), "limits.lateness_s") == FindingLevel::good);
}

TEST_CASE("a speed limit far above the reference is questioned") {
  CHECK(level_of(graded(cylinder, {"limits.speed_mps=3"}), "limits.speed_mps") == FindingLevel::acceptable);
}

TEST_CASE("what a rig on devices lacks is named") {
  const auto bare = graded(on_devices);
  CHECK(level_of(bare, "emergency stop") == FindingLevel::unsafe);
  CHECK(level_of(bare, "enable output") == FindingLevel::unsafe);
  CHECK(level_of(bare, "readback of the valve's command") == FindingLevel::unsafe);
  CHECK(level_of(bare, "limit switch at each end") == FindingLevel::acceptable);
  CHECK(level_of(bare, "sensor in each chamber") == FindingLevel::acceptable);
  const auto wired = graded(on_devices, {"hal.gpio.emergency_stop={line: ESTOP}", "hal.gpio.enable={line: ENABLE}"});
  for (const char* topic : {"emergency stop", "enable output"})
    CHECK(std::none_of(wired.begin(), wired.end(), [&](const Finding& finding) { return finding.topic == topic; }));
}

TEST_CASE("a real valve that is driven by a simulated sensor is unsafe") {
  const std::string x = "hal.channels.x={simulated: true}";
  CHECK(level_of(graded(on_devices, {x}), "simulated feedback") == FindingLevel::unsafe);
  CHECK(level_of(graded("mixed/cylinder-10m-7.65mm.yaml"), "simulated feedback") == FindingLevel::unsafe);
  const auto supply = graded(on_devices, {"hal.channels.p_supply={simulated: true}"});
  CHECK(
      std::none_of(supply.begin(), supply.end(), [](auto& finding) { return finding.topic == "simulated feedback"; }));
}

TEST_CASE("a rod side that is larger than the other is questioned") {
  const auto findings = graded(cylinder, {"cylinder.area_2_m2=1.4e-3", "initial.pressure_2_Pa=4e5"});
  CHECK(level_of(findings, "cylinder areas") == FindingLevel::acceptable);
}
