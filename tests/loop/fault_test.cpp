// Faults of the loop: spikes are bridged, failures latch the right cause with the safe output in the same tick, and
// rearm() leads back; no fault in normal running.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/run_length.hpp"
#include "loop/faulty_backend.hpp"
#include "loop/loop_rigs.hpp"
#include "loop/recorded_run.hpp"
#include "loop/runner.hpp"
#include "record/files.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

constexpr std::int64_t first_bad = 700, forever = 1'000'000;

Rig rig_for(Signal channel) {
  const bool chamber = channel == Signal::p1_chamber || channel == Signal::p2_chamber;
  return config_rig("cylinder-10m-7.65mm",
                    {chamber ? "controller.pressure_source=chamber" : "controller.pressure_source=estimated",
                     "safe_output.command_V=0.25", "duration_s=2"});
}

/// Bits that may be the reason of a failure.
std::uint64_t expected_bit(Signal channel, FailureMode mode) {
  const auto n = static_cast<std::size_t>(channel);
  constexpr std::array<std::uint64_t, 5> missing{fault_position_missing, fault_port_pressure_1_missing,
                                                 fault_port_pressure_2_missing, fault_chamber_pressure_1_missing,
                                                 fault_chamber_pressure_2_missing};
  constexpr std::array<std::uint64_t, 5> frozen{fault_position_frozen, fault_port_pressure_1_frozen,
                                                fault_port_pressure_2_frozen, fault_chamber_pressure_1_frozen,
                                                fault_chamber_pressure_2_frozen};
  constexpr std::array<std::uint64_t, 5> jump{fault_position_jump, fault_port_pressure_1_jump,
                                              fault_port_pressure_2_jump, fault_chamber_pressure_1_jump,
                                              fault_chamber_pressure_2_jump};
  if (mode == FailureMode::frozen) return frozen[n];
  if (mode == FailureMode::jumped) return jump[n];
  return missing[n];
}

double jump_of(Signal channel) { return channel == Signal::x ? -0.04 : 180e3; }

struct Stepper {
  explicit Stepper(const Rig& rig) : backend(rig) {
    loop.configure(rig);
    backend.configure();
    backend.activate();
  }
  const Row& step() {
    loop.pass(backend, tick++, 0, nullptr, nullptr);
    return loop.row();
  }
  FaultyBackend backend;
  AxisLoop loop;
  std::int64_t tick = 0;
};

}  // namespace

TEST_CASE("every failure of every channel latches its fault, safe output in that tick, and rearm leads back") {
  const auto channel = GENERATE(Signal::x, Signal::p1_port, Signal::p2_port, Signal::p1_chamber, Signal::p2_chamber);
  const auto mode = GENERATE(FailureMode::dropped_out, FailureMode::not_a_number, FailureMode::frozen,
                             FailureMode::jumped, FailureMode::out_of_range);
  const Rig rig = rig_for(channel);
  Stepper run(rig);
  run.backend.failure = {channel, mode, first_bad, forever, jump_of(channel)};
  while (run.loop.faults() == 0 && run.tick < 2000) run.step();
  const std::int64_t fault_tick = run.tick - 1;
  CAPTURE(static_cast<int>(channel), static_cast<int>(mode), fault_tick, run.loop.first_faults());
  // A position that stops at once leaves the prediction before it counts as frozen.
  const bool leaves = channel == Signal::x && mode == FailureMode::frozen;
  REQUIRE(run.loop.first_faults() == (leaves ? fault_deviation : expected_bit(channel, mode)));
  // What is missing is known at once; the first samples of a jump cannot be told from a spike.
  if (mode == FailureMode::frozen) REQUIRE((fault_tick >= first_bad + 2 && fault_tick <= first_bad + 600));
  else REQUIRE(fault_tick == first_bad + (mode == FailureMode::jumped ? 2 : 0));
  REQUIRE(run.loop.row().u_V == rig.safe_output.command_V);
  REQUIRE((run.loop.row().flags & row_fault) != 0);
  REQUIRE(run.loop.row().fault == run.loop.first_faults());
  REQUIRE(run.backend.commands_V.size() == static_cast<std::size_t>(run.tick));
  REQUIRE(run.backend.commands_V.back() == rig.safe_output.command_V);
  REQUIRE(run.backend.commands_V[run.backend.commands_V.size() - 2] != rig.safe_output.command_V);

  // It stays safe although the sensor comes back.
  run.backend.failure.ticks = 0;
  for (int i = 0; i < 100; ++i) REQUIRE(run.step().u_V == rig.safe_output.command_V);
  REQUIRE(run.loop.faults() != 0);

  run.loop.rearm();
  REQUIRE(run.loop.faults() == 0);
  double worst_after_approach = 0.0;
  // The safe output of this test moves the slider: it is taken over at the end stop, where it rests.
  for (int i = 0; i < 9000; ++i) {
    const Row& row = run.step();
    REQUIRE(row.fault == 0);
    if (i > 7500) worst_after_approach = std::max(worst_after_approach, std::fabs(row.x_ref_m - row.x_true_m));
  }
  REQUIRE(worst_after_approach < 0.05);  // this tuning follows 80 mm at 1 Hz to 34 mm
}

TEST_CASE("a spike of one or two ticks in any channel is bridged") {
  const auto channel = GENERATE(Signal::x, Signal::p1_port, Signal::p2_port, Signal::p1_chamber, Signal::p2_chamber);
  const auto mode = GENERATE(FailureMode::dropped_out, FailureMode::not_a_number, FailureMode::frozen,
                             FailureMode::jumped, FailureMode::out_of_range);
  Rig rig = rig_for(channel);
  rig.limits.missing_ticks = 2;
  Stepper run(rig), healthy(rig);
  double worst_V = 0.0;
  std::int64_t worst_at = 0;
  for (int spike = 0; spike < 12; ++spike) {
    const std::int64_t at = first_bad + std::int64_t{97} * spike;
    run.backend.failure = {channel, mode, at, 1 + spike % 2, jump_of(channel)};
    while (run.tick < at + 97) {
      const Row& row = run.step();
      const double moved_V = std::fabs(row.u_V - healthy.step().u_V);
      const bool bad = row.t_s > (static_cast<double>(at) - 0.5) * rig.period_s &&
                       row.t_s < (static_cast<double>(at + 1 + spike % 2) - 0.5) * rig.period_s;
      if (mode != FailureMode::frozen) REQUIRE(((row.flags & row_input_bridged) != 0) == bad);
      if (moved_V > worst_V) worst_V = moved_V, worst_at = run.tick - at;
      REQUIRE(run.loop.faults() == 0);
    }
  }
  CAPTURE(static_cast<int>(channel), static_cast<int>(mode), worst_at);
  REQUIRE(worst_V < 0.5);  // a jump that got through would move it by more than 1 V
}

TEST_CASE("an output that is not written is a fault, the safe output is tried at once") {
  const Rig rig = rig_for(Signal::x);
  Stepper run(rig);
  run.backend.fails_to_write_at = 100;
  for (int i = 0; i < 101; ++i) run.step();
  REQUIRE(run.loop.first_faults() == fault_output_missed);
  REQUIRE(run.step().u_V == rig.safe_output.command_V);
  REQUIRE(run.backend.commands_V.back() == rig.safe_output.command_V);
  run.loop.rearm();
  for (int i = 0; i < 500; ++i) REQUIRE(run.step().fault == 0);
}

TEST_CASE("speed and range have their own faults") {
  SECTION("speed") {
    Rig rig = config_rig("cylinder-10m-7.65mm", {"duration_s=2"});
    rig.limits.speed_mps = 0.1;  // which a config with this reference is refused for
    Stepper run(rig);
    while (run.loop.faults() == 0 && run.tick < 2000) run.step();
    REQUIRE(run.loop.first_faults() == fault_speed);
    run.loop.rearm();
    REQUIRE(run.step().fault == 0);
  }
  SECTION("range: the encoder's zero is off") {
    Stepper run(config_rig("cylinder-10m-7.65mm",
                           {"duration_s=2", "initial.position_m=0.1", "concealed={'sensor_offset:x': {offset: 0.1}}"}));
    while (run.loop.faults() == 0 && run.tick < 2000) run.step();
    REQUIRE((run.loop.first_faults() & fault_position_range) != 0);
  }
  SECTION("no finite command") {
    Rig rig = config_rig("cylinder-10m-7.65mm", {"duration_s=2"});
    rig.controller.of<PdForce>().position_gain_N_per_m = std::numeric_limits<double>::quiet_NaN();
    Stepper run(rig);
    REQUIRE(run.step().fault == fault_command_not_finite);
    REQUIRE(run.loop.row().u_V == 0.0);
  }
  SECTION("no usable estimate, and none that is not needed") {
    const Rig rig = config_rig("cylinder-10m-7.65mm");
    SimBackend plant(rig);
    plant.configure();
    plant.activate();
    Supervisor supervisor;
    supervisor.configure(rig, false);
    for (std::int64_t tick = 0; tick < 3; ++tick) {
      Measurement measured;
      plant.read(tick, measured);
      supervisor.judge(measured, 0);
    }
    REQUIRE(supervisor.is_active());
    supervisor.check_motion({.motion = {}, .command_good = true, .estimate_usable = true});
    REQUIRE(supervisor.faults() == 0);
    supervisor.check_motion({.motion = {}, .command_good = true, .estimate_usable = false});
    REQUIRE(supervisor.first_faults() == fault_estimate_invalid);
  }
}

TEST_CASE("a loop without an estimate: a fault where it closes on the estimate, none where it closes on the ports") {
  // Positions beyond 0.6 strokes, which the limits allow here, give the estimator nothing to start from.
  for (const std::string source : {"estimated", "valve"}) {
    Stepper run(config_rig("cylinder-10m-7.65mm",
                           {"controller.pressure_source=" + source, "initial.position_m=0.1",
                            "concealed={'sensor_offset:x': {offset: 0.1}}", "limits.position_margin_m=0.1",
                            "limits.deviation_m=0", "limits.speed_deviation_mps=0", "limits.stall_force_N=0"}));
    for (int i = 0; i < 20; ++i) run.step();
    CAPTURE(source, run.loop.row().measured[Signal::x]);
    REQUIRE(std::isnan(run.loop.row().p1_estimated_Pa));
    REQUIRE(run.loop.first_faults() == (source == "valve" ? 0 : std::uint64_t{fault_estimate_invalid}));
    const bool active = run.loop.row().state == static_cast<std::uint32_t>(SupervisorState::active);
    REQUIRE(active == (source == "valve"));
  }
}

TEST_CASE("a channel that comes late at the start is waited for in the safe output, one that never comes is missing") {
  Rig rig = rig_for(Signal::x);
  rig.safe_output.command_V = 0.01;  // too little to move the slider in 50 ms
  Stepper run(rig);
  const auto ticks = GENERATE(std::int64_t{50}, forever);
  run.backend.failure = {Signal::p1_port, FailureMode::dropped_out, 0, ticks, 0.0};
  for (int i = 0; i < 50; ++i) {
    REQUIRE(run.step().u_V == rig.safe_output.command_V);
    REQUIRE(run.loop.row().fault == 0);
    REQUIRE(std::isnan(run.loop.row().x_ref_m));
    REQUIRE(std::isnan(run.loop.row().p1_estimated_Pa));
  }
  for (int i = 0; i < 60; ++i) run.step();
  const std::uint64_t expected = ticks == forever ? std::uint64_t{fault_port_pressure_1_missing} : 0;
  REQUIRE(run.loop.first_faults() == expected);
  if (ticks != forever) REQUIRE(std::isfinite(run.loop.row().x_ref_m));
}

TEST_CASE("a slider that moves while a channel is waited for is taken over at rest, without a fault") {
  const Rig rig = rig_for(Signal::x);  // its safe output of 0.25 V drives the slider to the end stop
  Stepper run(rig);
  run.backend.failure = {Signal::p1_port, FailureMode::dropped_out, 0, 50, 0.0};
  double way_m = 0.0, before_m = 0.0;
  while (!std::isfinite(run.loop.row().x_ref_m) && run.tick < 5000) {
    before_m = run.loop.row().measured[Signal::x];
    way_m = run.step().measured[Signal::x] - before_m;
  }
  REQUIRE(run.tick > 500);
  REQUIRE(run.tick < 5000);
  REQUIRE(std::fabs(way_m) < 1e-4);
  for (int i = 0; i < 1500; ++i) run.step();
  REQUIRE(run.loop.faults() == 0);
}

TEST_CASE("a faulted run keeps every row, tells the reason in words and ends safe") {
  const TemporaryFolder folder;
  const Rig rig = rig_for(Signal::p1_port);
  FaultyBackend backend(rig);
  backend.configure();
  backend.failure = {Signal::p1_port, FailureMode::not_a_number, 900, forever, 0.0};
  RecordingWriter writer(folder.file("run.csv.gz"), RecordingHeader(rig.name, rig.period_s), {});
  RunSettings settings;
  settings.writer = &writer;
  const RunOutcome outcome = run_loop(rig, backend, settings);
  writer.close();
  REQUIRE_FALSE(backend.active);
  REQUIRE(backend.commands_V.back() == rig.safe_output.command_V);
  REQUIRE(outcome.faults.size() == 1);
  REQUIRE(outcome.faults[0].rfind("port_pressure_1_missing: port pressure 1 was missing", 0) == 0);
  REQUIRE(outcome.fault_s == Approx(0.9));
  const Recording recording = read_recording(folder.file("run.csv.gz"));
  REQUIRE(recording.rows() == outcome.rows.size());
  REQUIRE(recording.rows() >= 1200);  // 0.3 s after the fault
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    REQUIRE(recording.column("t_s")[i] == Approx(static_cast<double>(i) * 1e-3));
    REQUIRE(recording.column("fault")[i] == (i < 900 ? 0.0 : double(fault_port_pressure_1_missing)));
    if (i >= 900) REQUIRE(recording.column("u_V")[i] == rig.safe_output.command_V);
  }
  REQUIRE(std::isnan(recording.column("p1_port_Pa")[900]));  // as it came, not as it was bridged
}

TEST_CASE("every fault has one text with a remedy, and the numbers of the bits stay as they are documented") {
  std::uint64_t seen = 0;
  for (const FaultText& text : fault_texts) {
    REQUIRE((seen & text.bit) == 0);
    seen |= text.bit;
    REQUIRE(text.meaning.find(": ") != std::string_view::npos);
    REQUIRE(fault_words(text.bit, text.bit).size() == 1);
  }
  REQUIRE(seen == 0x1F3FFFFFFFFFFFull);
  REQUIRE(fault_words(fault_speed, fault_speed | fault_position_missing).front().rfind("speed:", 0) == 0);
}

TEST_CASE("no fault in normal running: three pressure sources, noise or none, feedforward, nine lines in the long run",
          "[long]") {
  for (const std::string& name : test::is_long_run() ? nine_configs() : lines_of_the_range()) {
    for (const char* source : {"estimated", "valve", "chamber"})
      for (const bool noise : {true, false})
        for (const char* feedforward : {"off", "formula", "pass"}) {
          std::vector<std::string> sets{std::string("controller.pressure_source=") + source,
                                        std::string("controller.flow_feedforward=") + feedforward, "duration_s=3",
                                        "seed=7", "initial.position_m=-0.05"};
          if (!noise)
            for (const char* channel : {"port_pressure", "chamber_pressure"})
              for (const char* key : {"noise_Pa", "quantum_Pa"})
                sets.push_back(std::string("sensors.") + channel + "." + key + "=0");
          const Rig rig = config_rig(name, sets);
          SimBackend backend(rig);
          backend.configure();
          const RunOutcome outcome = run_loop(rig, backend, {});
          CAPTURE(name, source, noise, feedforward, outcome.fault_s, outcome.faults);
          REQUIRE(outcome.faults.empty());
          REQUIRE(outcome.moves.size() == 1);
        }
  }
}

TEST_CASE("no fault while resting, against an end stop, with friction that sticks, or on coarse encoders") {
  // By the formula these lines start faster than a first motion may be.
  constexpr const char* without_feedforward = "controller.flow_feedforward=off";
  const auto sets = GENERATE(values<std::vector<std::string>>({
      {"reference={kind: minimum_jerk, start_m: 0.0, end_m: 0.02, start_s: 0.1, duration_s: 0.5}", "duration_s=20"},
      {"reference={kind: minimum_jerk, start_m: 0.0, end_m: 0.15, start_s: 0.1, duration_s: 0.3}", "duration_s=6",
       "sensors.port_pressure.noise_Pa=50", without_feedforward},
      {"reference={kind: minimum_jerk, start_m: 0.1, end_m: -0.15, start_s: 0.1, duration_s: 0.5}", "duration_s=6",
       "initial.position_m=0.15"},
      {"sensors.position.quantum_m=1e-3", "duration_s=6"},
      {"sensors.position.noise_m=5e-6", "sensors.position.quantum_m=5e-6", "duration_s=6"},
      {"reference.amplitude_m=0.001", "reference.frequency_Hz=0.2", "duration_s=20"},
      {"initial.pressure_1_Pa=110000", "duration_s=4"},
      {"reference={kind: waypoints, times_s: [0.2, 0.5, 1.0, 1.4], positions_m: [0.0, 0.14, 0.14, -0.14]}",
       "duration_s=3", without_feedforward},
  }));
  for (const char* name : {"cylinder-10m-4.15mm", "cylinder-2m-7.65mm"}) {
    const Rig rig = config_rig(name, sets);
    SimBackend backend(rig);
    backend.configure();
    const RunOutcome outcome = run_loop(rig, backend, {});
    CAPTURE(name, sets, outcome.fault_s, outcome.faults);
    REQUIRE(outcome.faults.empty());
  }
}
