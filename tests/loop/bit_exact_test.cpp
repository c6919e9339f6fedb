// The same numbers bit for bit: real and simulated time, a run and its replay; and a difference of one bit is found.
#include <catch2/catch.hpp>

#include <bit>
#include <cmath>

#include "loop/faulty_backend.hpp"
#include "loop/loop_rigs.hpp"
#include "loop/realtime_stop.hpp"
#include "loop/recorded_run.hpp"
#include "loop/runner.hpp"
#include "record/files.hpp"

using namespace pneuservo;

namespace {

/// Rows [0, n) are the same bits in all columns but those of real time; -1: all, else the first row that differs.
std::ptrdiff_t first_difference(const std::vector<Row>& a, const std::vector<Row>& b, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    bool same = true;
    Row::visit(
        [&](std::string_view name, const auto& x, const auto& y) {
          if (name == "lateness_us" || name == "work_us") return;
          const auto u = static_cast<double>(x), v = static_cast<double>(y);
          same = same && ((std::isnan(u) && std::isnan(v)) ||
                          std::bit_cast<std::uint64_t>(u) == std::bit_cast<std::uint64_t>(v));
        },
        a[i], b[i]);
    for (std::size_t k = 0; k < Row::most_terms; ++k)
      same = same && std::bit_cast<std::uint64_t>(a[i].terms[k]) == std::bit_cast<std::uint64_t>(b[i].terms[k]);
    if (!same) return static_cast<std::ptrdiff_t>(i);
  }
  return -1;
}

RunOutcome run_config(const Rig& rig, bool real_time) {
  SimBackend backend(rig);
  backend.configure();
  RunSettings settings;
  settings.real_time = real_time;
  return run_loop(rig, backend, settings);
}

struct Case {
  const char* name;
  const char* config;
  std::vector<std::string> sets;
  int moves = 1;
  std::vector<std::pair<std::int64_t, std::int64_t>> late;
  Failure failure;
};

std::vector<Case> cases() {
  const std::string move = "reference={kind: minimum_jerk, start_m: 0.0, end_m: 0.06, start_s: 0.1, duration_s: 0.4}";
  return {
      {"approach", "cylinder-10m-7.65mm", {"initial.position_m=0.05", "duration_s=1"}, 1, {}, {}},
      {"three moves", "cylinder-5m-6.10mm", {move, "duration_s=0.8"}, 3, {}, {}},
      {"flow feedforward", "cylinder-10m-6.10mm", {"controller.flow_feedforward=true", "duration_s=1"}, 1, {}, {}},
      {"command pass", "cylinder-5m-6.10mm", {move, "duration_s=0.8", "controller.flow_feedforward=pass"}, 2, {}, {}},
      {"port pressures", "cylinder-2m-7.65mm", {"controller.pressure_source=valve", "duration_s=1"}, 1, {}, {}},
      {"chamber pressures", "cylinder-2m-4.15mm", {"controller.pressure_source=chamber", "duration_s=1"}, 1, {}, {}},
      {"servo table",
       "servo-table-0.5m-4mm",
       {"duration_s=0.6", "simulation.cells_per_m=16", "initial.position_m=-0.0499",
        "controller.integral_gain_V_per_m_s=1e4"},
       1,
       {{2000, 1}, {4000, 12}},
       {}},
      {"servo table, learning",
       "servo-table-1m-8mm",
       {"duration_s=0.3", "simulation.cells_per_m=8", "controller.learning=flow",
        "reference={kind: waypoints, times_s: [0.0, 0.2], positions_m: [-0.05, -0.0499], smoothness: 9}"},
       2,
       {},
       {}},
      {"overruns",
       "cylinder-10m-7.65mm",
       {move, "duration_s=0.8", "limits.lateness_s=0.2"},
       2,
       {{100, 1}, {300, 7}, {301, 2}, {797, 4}, {900, 120}},
       {}},
      {"bridged gap",
       "cylinder-10m-4.15mm",
       {"duration_s=1", "limits.missing_ticks=2"},
       1,
       {},
       {Signal::x, FailureMode::dropped_out, 400, 2, 0.0}},
      {"fault",
       "cylinder-10m-4.15mm",
       {"duration_s=1"},
       1,
       {},
       {Signal::p2_port, FailureMode::not_a_number, 500, 10000, 0.0}},
  };
}

}  // namespace

TEST_CASE("real and simulated time give the same numbers bit for bit", "[long]") {
  for (const char* source : {"estimated", "valve", "chamber"}) {
    const Rig rig = config_rig("cylinder-10m-7.65mm", {"duration_s=0.4", "initial.position_m=0.01",
                                                       std::string("controller.pressure_source=") + source,
                                                       "controller.flow_feedforward=true"});
    const RunOutcome simulated = run_config(rig, false), real = run_config(rig, true);
    // A late tick skips its slots, which no simulation does: compared up to the first.
    std::size_t count = 0;
    while (count < real.rows.size() && (real.rows[count].flags & row_overrun) == 0) ++count;
    CAPTURE(source, real.overruns, count);
    if (real.overruns == 0) REQUIRE(count == simulated.rows.size());
    REQUIRE(count >= 1);
    REQUIRE(first_difference(real.rows, simulated.rows, count) == -1);
  }
}

TEST_CASE("a replay gives the recorded numbers bit for bit", "[long]") {
  for (const Case& c : cases()) {
    const TemporaryFolder folder;
    const Rig rig = config_rig(c.config, c.sets);
    FaultyBackend backend(rig);
    backend.failure = c.failure;
    const auto rows = recorded_run(rig, backend, folder.file("run.csv.gz"), c.moves, c.late);
    const ReplayResult result = replayed(rig, read_recording(folder.file("run.csv.gz")), c.moves);
    CAPTURE(c.name, result.differing_values);
    INFO((result.first ? result.first->column + " in row " + std::to_string(result.first->row)
                       : std::string("no difference")));
    REQUIRE(result.compared_rows == rows.size());
    REQUIRE(result.identical());
    const bool faulted = rows.back().fault != 0;
    REQUIRE(faulted == (std::string(c.name) == "fault"));
  }
}

TEST_CASE("an output that could not be written replays as it went") {
  const TemporaryFolder folder;
  const Rig rig = config_rig("cylinder-2m-7.65mm", {"duration_s=1"});
  FaultyBackend backend(rig);
  backend.fails_to_write_at = 300;
  recorded_run(rig, backend, folder.file("run.csv.gz"));
  const ReplayResult result = replayed(rig, read_recording(folder.file("run.csv.gz")));
  REQUIRE(result.identical());
  REQUIRE(result.rows.back().fault == fault_output_missed);
}

TEST_CASE("one bit in a parameter makes a replay differ") {
  const TemporaryFolder folder;
  const Rig rig = config_rig("cylinder-10m-7.65mm", {"duration_s=0.5", "controller.flow_feedforward=true"});
  FaultyBackend backend(rig);
  recorded_run(rig, backend, folder.file("run.csv.gz"));
  const Recording recording = read_recording(folder.file("run.csv.gz"));
  REQUIRE(replayed(rig, recording).identical());
  const auto bit = [](double& value) { value = std::nextafter(value, 1e300); };
  Rig planted = rig;
  std::string expected;
  SECTION("line diameter") { bit(planted.axis.line_1.diameter_m), expected = ""; }
  SECTION("viscosity") { bit(planted.axis.air.viscosity_Pas), expected = ""; }
  SECTION("wall heat") { bit(planted.axis.cylinder.wall_heat_W_per_m2K), expected = "p"; }
  SECTION("piston area") { bit(planted.axis.cylinder.area_2_m2), expected = ""; }
  SECTION("position gain") {
    bit(planted.controller.of<PdForce>().position_gain_N_per_m), expected = "force_reference_N";
  }
  SECTION("force gain") { bit(planted.controller.of<PdForce>().force_gain_V_per_N), expected = "u_unlimited_V"; }
  SECTION("velocity filter") { bit(planted.controller.of<PdForce>().velocity_filter_s), expected = "v_mps"; }
  SECTION("lead of the feedforward") {
    bit(planted.controller.of<PdForce>().feedforward_lead_s), expected = "u_feedforward_V";
  }
  SECTION("amplitude") { bit(planted.reference.amplitude_m), expected = ""; }
  const ReplayResult result = replayed(planted, recording);
  REQUIRE_FALSE(result.identical());
  REQUIRE(result.differing_values > 0);
  CAPTURE(result.first->column, expected);
  REQUIRE(result.first->column.rfind(expected, 0) == 0);
}

TEST_CASE("one bit in one input makes a replay differ, from that row on") {
  const TemporaryFolder folder;
  const Rig rig = config_rig("cylinder-10m-7.65mm", {"duration_s=0.5"});
  FaultyBackend backend(rig);
  recorded_run(rig, backend, folder.file("run.csv.gz"));
  Recording recording = read_recording(folder.file("run.csv.gz"));
  const std::string column = GENERATE("x_m", "p1_port_Pa", "p2_port_Pa");
  const auto at = static_cast<std::size_t>(std::find(recording.names.begin(), recording.names.end(), column) -
                                           recording.names.begin());
  // The position's last bit; of a pressure one that is worth 2 mPa, as the last ones drown in the gas state's rounding.
  double& value = recording.values[at][250];
  value = std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^ (column == "x_m" ? 1u : 1u << 25));
  const ReplayResult result = replayed(rig, recording);
  CAPTURE(column);
  REQUIRE_FALSE(result.identical());
  REQUIRE(result.first->row >= 250);
  REQUIRE(result.first->row <= 300);
}

TEST_CASE("one bit in one recorded output is found where it is") {
  const TemporaryFolder folder;
  const Rig rig = config_rig("cylinder-2m-7.65mm", {"duration_s=0.3"});
  FaultyBackend backend(rig);
  recorded_run(rig, backend, folder.file("run.csv.gz"));
  Recording recording = read_recording(folder.file("run.csv.gz"));
  const auto at = static_cast<std::size_t>(std::find(recording.names.begin(), recording.names.end(), "u_V") -
                                           recording.names.begin());
  recording.values[at][123] = std::nextafter(recording.values[at][123], 1e300);
  const ReplayResult result = replayed(rig, recording);
  REQUIRE(result.differing_values == 1);
  REQUIRE(result.first->row == 123);
  REQUIRE(result.first->column == "u_V");
}
