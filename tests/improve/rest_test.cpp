// A resting axis behind long lines: what makes it swing, and what ends it.
#include <algorithm>
#include <cmath>
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

/// Largest error of the last second [m].
double rest_error_m(const RunResult& run) {
  double most_m = 0.0;
  for (const Row& row : run.rows)
    if (row.t_s > run.rows.back().t_s - 1.0) most_m = std::max(most_m, std::fabs(row.x_ref_m - row.x_true_m));
  return most_m;
}

TEST_CASE("a known dead band counts by half where the axis rests after a move, one that is not known as a whole") {
  const std::vector<std::string> move{
      "reference={kind: waypoints, times_s: [0, 0.8], positions_m: [0, 0.06], smoothness: 7}", "duration_s=4",
      "controller.flow_feedforward=formula"};
  const auto with = [&](const char* effects) {
    std::vector<std::string> sets = move;
    sets.emplace_back(std::string("effects=") + effects);
    return read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-5m-7.65mm.yaml", sets);
  };
  const Rig knowing = with("{valve_dead_band: {width_V: 0.05}}"), unaware = with("{}");
  const RunResult known = simulated_run(knowing, knowing), unknown = simulated_run(unaware, knowing);
  const PdForceParameters& law = unaware.controller.of<PdForce>();
  const double band_m = 0.05 / (law.force_gain_V_per_N * law.position_gain_N_per_m);
  INFO(1e3 * rest_error_m(known) << " and " << 1e3 * rest_error_m(unknown) << " of " << 1e3 * band_m << " mm");
  CHECK(rest_error_m(unknown) > 0.5 * band_m);
  CHECK(rest_error_m(known) < 0.5 * band_m + 0.05e-3);
}

TEST_CASE("an axis on short lines that knows its valve's play follows a move better and hunts by less after it") {
  const auto with = [](const char* effects) {
    return read_rig(
        PNEUSERVO_SOURCE_DIR "/config/cylinder-2m-7.65mm.yaml",
        {"reference={kind: waypoints, times_s: [0.5, 1.3, 3.3, 4.1], positions_m: [-0.06, 0.06, 0.06, -0.06], "
         "smoothness: 7}",
         "duration_s=6.1", "controller.flow_feedforward=formula", std::string("effects=") + effects});
  };
  const Rig knowing = with("{valve_hysteresis: {width_V: 0.05}}"), unaware = with("{}");
  const RunResult known = simulated_run(knowing, knowing), unknown = simulated_run(unaware, knowing);
  INFO(1e3 * rest_error_m(known) << " and " << 1e3 * rest_error_m(unknown) << " mm at rest");
  CHECK(rest_error_m(known) < 0.7 * rest_error_m(unknown));
  INFO(1e3 * known.metrics.max_position_error_m << " and " << 1e3 * unknown.metrics.max_position_error_m << " mm");
  CHECK(known.metrics.max_position_error_m < 0.7 * unknown.metrics.max_position_error_m);
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
