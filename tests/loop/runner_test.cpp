// Runs: the first approach, moves, late ticks in real time, a backend that ends, and the safe end of each.
#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>
#include <csignal>
#include <ctime>

#include "loop/fault_watch.hpp"
#include "loop/faulty_backend.hpp"
#include "loop/loop_rigs.hpp"
#include "loop/realtime_clock.hpp"
#include "loop/realtime_stop.hpp"
#include "loop/runner.hpp"
#include "record/files.hpp"
#include "record/writer.hpp"

using namespace pneuservo;

namespace {

/// The simulated plant on a machine that is late once, that raises a signal, or whose data end.
class EventfulBackend final : public Backend {
 public:
  explicit EventfulBackend(const Rig& rig) : plant_(rig) { plant_.configure(); }
  std::int64_t late_at = -1, signal_at = -1, ends_at = -1;
  long late_ns = 0;
  int deactivated = 0;
  double last_V = 99.0;

  void configure() override {}
  void activate() override {}
  bool read(std::int64_t tick, Measurement& measurement) noexcept override {
    if (late_at >= 0 && tick >= late_at) {
      late_at = -1;
      const timespec pause{0, late_ns};
      clock_nanosleep(CLOCK_MONOTONIC, 0, &pause, nullptr);
    }
    if (tick == signal_at) raise(SIGTERM);
    return tick != ends_at && plant_.read(tick, measurement);
  }
  bool write(std::int64_t tick, const Command& command) noexcept override {
    last_V = command.valve_V;
    return plant_.write(tick, command);
  }
  void deactivate() noexcept override { ++deactivated; }
  Truth truth() const noexcept override { return plant_.truth(); }
  Origins origins() const override { return plant_.origins(); }
  std::string name() const override { return "sim"; }

 private:
  SimBackend plant_;
};

/// The simulated plant under a clock of its own, which has gone on by more than a period at some ticks.
class PacedBackend final : public Backend {
 public:
  explicit PacedBackend(const Rig& rig) : plant_(rig) { plant_.configure(); }
  std::int64_t skips_late_at = -1, skips_early_at = -1;  ///< by calls

  void configure() override {}
  void activate() override {}
  bool is_paced() const noexcept override { return true; }
  Pace await_sample() noexcept override {
    const std::int64_t call = calls_++;
    return {call == skips_early_at ? 3 : call == skips_late_at ? 6 : 1, MonotonicClock::now_ns()};
  }
  bool read(std::int64_t tick, Measurement& measurement) noexcept override { return plant_.read(tick, measurement); }
  bool write(std::int64_t tick, const Command& command) noexcept override { return plant_.write(tick, command); }
  void deactivate() noexcept override {}
  Origins origins() const override { return plant_.origins(); }
  std::string name() const override { return "sim"; }

 private:
  SimBackend plant_;
  std::int64_t calls_ = 0;
};

RunOutcome run(const Rig& rig, Backend& backend, int moves = 1, bool real_time = false) {
  RunSettings settings;
  settings.moves = moves;
  settings.real_time = real_time;
  return run_loop(rig, backend, settings);
}

}  // namespace

TEST_CASE("the first start approaches the reference from the measured position without a jump") {
  for (const double from_m : {0.05, -0.05, 0.149, 0.0004}) {
    const Rig rig = config_rig("cylinder-10m-7.65mm", {"duration_s=1", "initial.position_m=" + std::to_string(from_m)});
    EventfulBackend backend(rig);
    const RunOutcome outcome = run(rig, backend);
    REQUIRE(outcome.faults.empty());
    const double start_s = outcome.moves.at(0).start_s;
    CAPTURE(from_m, start_s);
    if (std::fabs(from_m) <= AxisLoop::approach_tolerance_m) {
      REQUIRE(start_s == 0.0);
    } else {
      REQUIRE(start_s >= Approach::shortest_s);
      REQUIRE(start_s ==
              Approx(std::max(Approach::shortest_s, 10.0 * Approach::peak_over_mean * std::fabs(from_m))).margin(2e-3));
      REQUIRE(outcome.rows.front().x_ref_m == outcome.rows.front().measured[Signal::x]);
    }
    double largest_V = 0.0, largest_step_V = 0.0, fastest_mps = 0.0;
    for (std::size_t i = 1; i < outcome.rows.size() && outcome.rows[i].t_s < start_s; ++i) {
      const Row &row = outcome.rows[i], &before = outcome.rows[i - 1];
      largest_V = std::max(largest_V, std::fabs(row.u_V));
      largest_step_V = std::max(largest_step_V, std::fabs(row.u_V - before.u_V));
      fastest_mps = std::max(fastest_mps, std::fabs(row.v_ref_mps));
      REQUIRE(std::fabs(row.x_ref_m - before.x_ref_m) < 1.2 * Approach::speed_mps * rig.period_s);
    }
    REQUIRE(fastest_mps <= Approach::speed_mps * 1.001);
    REQUIRE(largest_V < 2.0);       // of 5 V
    REQUIRE(largest_step_V < 0.1);  // sensor noise makes 0.03 V
    const auto at = static_cast<std::size_t>(std::llround(start_s / rig.period_s));
    REQUIRE(outcome.rows.at(at).x_ref_m == Reference(rig.reference).at(0.0).d[0]);
    REQUIRE(outcome.rows.size() == at + 1000);
    REQUIRE(backend.deactivated == 1);
    REQUIRE(backend.last_V == rig.safe_output.command_V);
  }
}

TEST_CASE("moves repeat the reference, each judged from its own start") {
  const Rig rig =
      config_rig("cylinder-5m-6.10mm",
                 {"reference={kind: minimum_jerk, start_m: -0.02, end_m: 0.04, start_s: 0.1, duration_s: 0.4}",
                  "duration_s=1", "initial.position_m=-0.02"});
  EventfulBackend backend(rig);
  const RunOutcome outcome = run(rig, backend, 3);
  REQUIRE(outcome.moves.size() == 3);
  std::size_t begin = 0;
  for (const MoveSpan& move : outcome.moves) {
    REQUIRE(move.begin == begin);
    begin = move.end;
    REQUIRE(move.overruns == 0);
    // The whole reference from its time 0 stands in the move's rows.
    const auto first = static_cast<std::size_t>(std::llround(move.start_s / rig.period_s));
    REQUIRE(first >= move.begin);
    REQUIRE(move.end == first + 1000);
    for (std::size_t k = 0; k < 1000; ++k)
      REQUIRE(outcome.rows[first + k].x_ref_m == Approx(outcome.rows[k].x_ref_m).margin(1e-12));
  }
  REQUIRE(begin == outcome.rows.size());
  REQUIRE(outcome.moves[1].start_s > 1.0 + Approach::shortest_s - 1e-9);  // back to -0.02 first
}

TEST_CASE("a late tick keeps the phase, is counted and marked, and the axis goes on", "[timing]") {
  const Rig rig = config_rig("cylinder-10m-7.65mm", {"duration_s=0.6", "limits.missed_share=1"});
  const TemporaryFolder folder;
  EventfulBackend backend(rig);
  backend.late_at = 300;
  backend.late_ns = 20'500'000;
  const auto ring = std::make_shared<RecordingRing>();
  RunOutcome outcome;
  {
    RecordingWriter writer(folder.file("run.csv.gz"), RecordingHeader(rig.name, rig.period_s), {}, {.ring = ring});
    RunSettings settings;
    settings.real_time = true;
    settings.ring = ring.get();
    outcome = run_loop(rig, backend, settings);
    REQUIRE(writer.close().dropped == 0);
  }
  CAPTURE(outcome.faults);
  REQUIRE(outcome.faults.empty());
  REQUIRE(outcome.overruns >= 20);
  // Every slot from the first to the last was run or counted; on a slow machine the last one may itself come late.
  REQUIRE(outcome.ticks + outcome.overruns == std::llround(outcome.rows.back().t_s / rig.period_s) + 1);
  REQUIRE(outcome.ticks + outcome.overruns >= 600);
  REQUIRE(outcome.moves.at(0).overruns == outcome.overruns);
  const Recording recording = read_recording(folder.file("run.csv.gz"));
  REQUIRE(recording.rows() == static_cast<std::size_t>(outcome.ticks));
  REQUIRE(recording.missing_rows == static_cast<std::size_t>(outcome.overruns));
  REQUIRE(recording.dropped_rows == 0);
  std::int64_t before = -1;
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    const double t = recording.column("t_s")[i];
    const std::int64_t tick = std::llround(t / rig.period_s);
    REQUIRE(t == static_cast<double>(tick) * rig.period_s);  // on the grid, whatever happened
    const bool overrun = (static_cast<unsigned>(recording.column("flags")[i]) & row_overrun) != 0;
    REQUIRE(overrun == (tick != before + 1));
    before = tick;
  }
}

TEST_CASE("samples of a paced backend that were slept through are overruns, after the warm-up in the timing, too") {
  const Rig rig = config_rig("cylinder-10m-7.65mm", {"duration_s=0.6", "limits.missed_share=1"});
  PacedBackend backend(rig);
  backend.skips_early_at = 50;  // two slots
  backend.skips_late_at = 400;  // five
  const RunOutcome outcome = run(rig, backend, 1, true);
  CAPTURE(outcome.faults);
  REQUIRE(outcome.faults.empty());
  CHECK(outcome.overruns == 7);
  CHECK(outcome.moves.at(0).overruns == 7);
  REQUIRE(outcome.timing != nullptr);
  CHECK(outcome.timing->overruns == 5);
  CHECK(outcome.ticks + outcome.overruns == 600);
}

TEST_CASE("a late tick on a fast axis is neither a jump nor a speed") {
  // 0.5 m/s for 100 ms: 50 mm from one sample to the next.
  // So many slots are missed that no prediction holds, which is another test's matter.
  const Rig rig =
      config_rig("cylinder-2m-7.65mm", {"duration_s=2", "limits.deviation_m=0", "limits.speed_deviation_mps=0",
                                        "limits.missed_share=1", "limits.speed_mps=4", "limits.checks_rest_s=0"});
  FaultyBackend backend(rig);
  AxisLoop loop;
  loop.configure(rig);
  backend.configure();
  std::int64_t skipped = 0;
  for (std::int64_t served = 1, tick = 0; tick < 2000; ++served, tick += 1 + skipped) {
    loop.pass(backend, tick, skipped, nullptr, nullptr);
    CAPTURE(tick, skipped, loop.faults());
    REQUIRE(loop.faults() == 0);
    REQUIRE(std::fabs(loop.row().v_mps) < 4.0);  // 20 if 100 ms counted as 1 ms
    skipped = served % 150 == 0 ? 100 : 0;
  }
}

TEST_CASE("a run keeps its last rows and moves, however long it is") {
  const Rig rig = config_rig("cylinder-2m-4.15mm", {"duration_s=0.1"});
  SimBackend backend(rig);
  backend.configure();
  AxisLoop loop;
  loop.configure(rig);
  constexpr std::size_t kept = 150;
  Course course(rig, 2'000'000'000, kept);
  backend.activate();
  std::vector<Row> all;
  for (std::int64_t tick = 0; course.moves_begun() < 5; ++tick) {
    loop.pass(backend, tick, 0, nullptr, nullptr);
    all.push_back(loop.row());
    REQUIRE(course.after(tick, loop));
  }
  const auto moves = course.moves();
  const std::vector<Row> rows = course.take_rows();
  REQUIRE(rows.size() == kept);
  for (std::size_t i = 0; i < kept; ++i) REQUIRE(rows[i].t_s == all[all.size() - kept + i].t_s);
  REQUIRE(moves.back().number == 5);
  REQUIRE(moves.back().end == kept);
  REQUIRE(moves.front().begin == 0);
  REQUIRE(moves.front().rows_lost > 0);
  for (std::size_t i = 1; i < moves.size(); ++i) {
    REQUIRE(moves[i].begin == moves[i - 1].end);
    REQUIRE(moves[i].number == moves[i - 1].number + 1);
    REQUIRE(moves[i].rows_lost == 0);
  }
}

TEST_CASE("the first fault is told from beside the loop, before the run ends") {
  const Rig rig = config_rig("cylinder-2m-4.15mm", {"duration_s=1"});
  std::atomic<std::uint64_t> told{0};
  RunOutcome outcome;
  {
    FaultWatch watch([&](std::uint64_t first, double) { told = first; });
    FaultyBackend backend(rig);
    backend.configure();
    backend.failure = {Signal::p1_port, FailureMode::not_a_number, 500, 1 << 30, 0.0};
    RunSettings settings;
    settings.fault_watch = &watch;
    outcome = run_loop(rig, backend, settings);
  }
  REQUIRE(outcome.faults.size() >= 1);
  REQUIRE(fault_words(told, told).front() == outcome.faults.front());
}

TEST_CASE("SIGTERM ends a run with safe output, in simulated and real time") {
  const bool real_time = GENERATE(false, true);
  const StopRequest stop;
  const Rig rig = config_rig("cylinder-2m-4.15mm", {"duration_s=3", "safe_output.command_V=0.5"});
  EventfulBackend backend(rig);
  backend.signal_at = 150;
  const RunOutcome outcome = run(rig, backend, 1, real_time);
  CAPTURE(real_time, outcome.faults, outcome.overruns);
  if (outcome.overruns > 0 && !outcome.stopped_by_signal) return;  // that very tick was skipped
  REQUIRE(outcome.stopped_by_signal);
  if (outcome.overruns == 0) REQUIRE(outcome.faults.empty());  // missed slots are a fault of a loaded machine
  REQUIRE(outcome.rows.size() <= 152);
  REQUIRE(outcome.moves.size() == 1);
  REQUIRE(backend.last_V == 0.5);
  REQUIRE(backend.deactivated == 1);
}

TEST_CASE("a backend that ends, ends the run: rows kept, safe output") {
  const bool real_time = GENERATE(false, true);
  const Rig rig = config_rig("cylinder-2m-4.15mm", {"duration_s=3"});
  EventfulBackend backend(rig);
  backend.ends_at = 100;
  const RunOutcome outcome = run(rig, backend, 1, real_time);
  if (!outcome.ended_by_backend) return;  // that very tick was skipped
  REQUIRE(outcome.rows.size() + static_cast<std::size_t>(outcome.overruns) == 100);
  REQUIRE(backend.last_V == rig.safe_output.command_V);
  REQUIRE(backend.deactivated == 1);
}
