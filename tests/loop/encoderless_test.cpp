// The axis without an encoder: moves between two switches on air and force, with a bound, ended where it is not known.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "loop/faulty_backend.hpp"
#include "loop/loop_rigs.hpp"
#include "loop/recorded_run.hpp"
#include "record/files.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

/// 80 mm forth and back from one switch over the other, 1 s each, with 1 s of rest.
Rig encoderless_rig(std::vector<std::string> sets = {}) {
  sets.insert(
      sets.begin(),
      {"position={source: estimated, low_m: -0.034, high_m: 0.034, start_m: -0.04, hysteresis_m: 0.001}",
       "initial.position_m=-0.04",
       "reference={kind: waypoints, times_s: [0.2, 1.2, 2.2, 3.2, 4.2, 5.2, 6.2, 7.2], positions_m: [-0.04, 0.04, "
       "0.04, -0.04, -0.04, 0.04, 0.04, -0.04], smoothness: 5}",
       "controller.flow_feedforward=formula", "duration_s=8.2",
               // Half of what is used with an encoder, which answers sooner than the observer.
       "controller.position_gain_N_per_m=8950", "controller.velocity_gain_Ns_per_m=392"});
  return config_rig("cylinder-2m-7.65mm", sets);
}

struct Judged {
  long ticks = 0, within = 0;
  double after_2_s_m = 0.0, largest_m = 0.0;
};

/// Ticks in which the axis is active; errors two seconds after the last change of a switch.
Judged judged(const std::vector<Row>& rows) {
  Judged out;
  std::size_t passed = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const Row& row = rows[i];
    if (row.switches != rows[i - 1].switches) passed = i;
    if (static_cast<SupervisorState>(row.state) != SupervisorState::active) continue;
    const double error_m = std::fabs(row.x_estimated_m - row.x_true_m);
    ++out.ticks;
    out.within += error_m <= row.x_bound_m ? 1 : 0;
    out.largest_m = std::max(out.largest_m, error_m);
    if (passed > 0 && i >= passed + 2000) out.after_2_s_m = std::max(out.after_2_s_m, error_m);
  }
  return out;
}

std::vector<Row> rows_of(const Rig& rig, Backend& backend) {
  const TemporaryFolder folder;
  return recorded_run(rig, backend, folder.file("run.csv.gz"));
}

}  // namespace

TEST_CASE("without an encoder: drawn machines move between their switches within the bound that is stated") {
  const auto machine = GENERATE(1, 2, 3);
  CAPTURE(machine);
  Rig rig = encoderless_rig({"seed=" + std::to_string(machine), "duration_s=10.5"});
  Random draws(static_cast<std::uint64_t>(machine));
  for (const auto& [path, share] : rig.tolerances) rig.deviations[path] = share * std::clamp(draws.normal(), -2.0, 2.0);
  SimBackend backend(rig, SimBackend::Has::sensors_of_the_config);
  const auto rows = rows_of(rig, backend);
  REQUIRE(rows.back().fault == 0);
  const Judged result = judged(rows);
  CAPTURE(result.largest_m, result.after_2_s_m);
  CHECK(result.ticks > 8000);
  CHECK(result.within >= result.ticks * 99 / 100);
  CHECK(result.after_2_s_m > 0.0);
  CHECK(result.after_2_s_m < 3e-3);
}

TEST_CASE("without an encoder: what one shows is not used, and the recording replays bit for bit") {
  const Rig rig = encoderless_rig({"duration_s=3"});
  const TemporaryFolder folder;
  SimBackend sensed(rig, SimBackend::Has::sensors_of_the_config);
  const auto rows = recorded_run(rig, sensed, folder.file("run.csv.gz"));
  REQUIRE(rows.back().fault == 0);
  FaultyBackend blind(rig);
  blind.failure = {Signal::x, FailureMode::dropped_out, 0, 1'000'000};
  const auto others = rows_of(rig, blind);
  REQUIRE(others.size() == rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    REQUIRE(rows[i].u_V == others[i].u_V);
    REQUIRE(rows[i].x_estimated_m == others[i].x_estimated_m);
    REQUIRE(std::isnan(others[i].measured[Signal::x]));
  }
  CHECK(rows[1500].switches != rows[3500].switches);
  const Recording recording = read_recording(folder.file("run.csv.gz"));
  const ReplayResult replay = replayed(rig, recording);
  CHECK(replay.rows.size() == rows.size());
  CHECK(replay.identical());
  for (std::size_t i = 0; i < rows.size(); ++i) REQUIRE(replay.rows[i].x_estimated_m == rows[i].x_estimated_m);
}

TEST_CASE("without an encoder: a bound above what is allowed ends the run") {
  Rig rig = encoderless_rig({"position.bound_max_m=0.004", "position.leak_kgps=2e-5"});
  rig.position.low_m = -0.14, rig.position.high_m = 0.14;  // never passed
  SimBackend backend(rig, SimBackend::Has::sensors_of_the_config);
  const auto rows = rows_of(rig, backend);
  CHECK(rows.back().fault == fault_position_unknown);
  CHECK(rows.back().u_V == 0.0);
  const auto first = std::ranges::find_if(rows, [](const Row& row) { return row.fault != 0; });
  CHECK(first->x_bound_m == Approx(0.004).epsilon(0.05));
}

TEST_CASE("without an encoder: what the config asks must be possible") {
  CHECK_THROWS_WITH(encoderless_rig({"position.low_m=0.05"}), Catch::Contains("position.low_m"));
  CHECK_THROWS_WITH(encoderless_rig({"position.high_m=0.2"}), Catch::Contains("position.low_m"));
  CHECK_THROWS_WITH(encoderless_rig({"position.start_m=0.2", "initial.position_m=0"}),
                    Catch::Contains("position.start_m"));
  CHECK_THROWS_WITH(
      config_rig("servo-table-2m-8mm", {"position={source: estimated, low_m: -0.03, high_m: 0.03, start_m: 0}"}),
      Catch::Contains("position.source"));
}
