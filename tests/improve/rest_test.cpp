// A resting axis behind long lines: what makes it swing, and what ends it.
#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "config/read_rig.hpp"
#include "improve/simulated_run.hpp"

namespace pneuservo {
namespace {

RunResult run_of(const std::string& line, std::vector<std::string> sets) {
  const Rig rig = read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-" + line + "mm.yaml", sets);
  return simulated_run(rig, rig);
}

/// Largest less smallest command of the last second [V].
double command_swing_V(const RunResult& run) {
  double lowest = infinite, highest = -infinite;
  for (const Row& row : run.rows)
    if (row.t_s > run.rows.back().t_s - 1.0) lowest = std::min(lowest, row.u_V), highest = std::max(highest, row.u_V);
  return highest - lowest;
}

TEST_CASE("the 5 m lines' first mode swings in the force loop at rest, and not with the modal filter") {
  for (const char* line : {"5m-7.65", "5m-4.15"}) {
    const std::string rest = "reference={kind: minimum_jerk, start_m: 0, end_m: 0.06, duration_s: 0.6}";
    const RunResult seen = run_of(line, {rest, "duration_s=3", "controller.modal_filter=none"}),
                    filtered = run_of(line, {rest, "duration_s=3", "controller.modal_filter=line"});
    INFO(line << ": " << command_swing_V(seen) << " and " << command_swing_V(filtered) << " V");
    CHECK(command_swing_V(filtered) < 0.5 * command_swing_V(seen));
  }
}

TEST_CASE("the modal filter costs a moving axis no accuracy: the lines' loss is not fed back") {
  const std::vector<std::string> formula{"controller.flow_feedforward=formula", "duration_s=3"};
  const auto error_m = [&](const char* filter) {
    std::vector<std::string> sets = formula;
    sets.push_back(std::string("controller.modal_filter=") + filter);
    return run_of("5m-4.15", sets).metrics.max_position_error_m;
  };
  const double without_m = error_m("none"), with_m = error_m("line");
  INFO(without_m << " and " << with_m << " m");
  CHECK(with_m < without_m);
}

TEST_CASE("a pass knows what the ports show in the force with a modal filter") {
  const RunResult run = run_of("5m-4.15", {"controller.modal_filter=line", "controller.flow_feedforward=pass"});
  REQUIRE(run.faults.empty());
  CHECK(run.metrics.max_position_error_m < 0.1e-3);
}

}  // namespace
}  // namespace pneuservo
