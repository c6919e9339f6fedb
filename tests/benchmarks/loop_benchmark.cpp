// Loop overhead with recording on: the loop's own work of a tick (row, ring, course, clock) beside the whole tick.
#include <benchmark/benchmark.h>

#include <memory>
#include <random>
#include <string>
#include <vector>

#include <pneuservo/control/live_planner.hpp>
#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/loop/timing.hpp>
#include <pneuservo/record/ring.hpp>

#include "bench_tools.hpp"
#include "config/read_rig.hpp"
#include "loop/course.hpp"
#include "loop/motion_limits.hpp"
#include "loop/realtime_clock.hpp"
#include "sim/sim_backend.hpp"

namespace {

using namespace pneuservo;

/// Ticks back to back with the stamps of real time; the ring is drained now and then, outside the clock.
void loop_tick(benchmark::State& state, const char* config, const std::vector<std::string>& sets) {
  Rig rig = read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/" + config + ".yaml", sets);
  SimBackend backend(rig);
  backend.configure();
  backend.activate();
  AxisLoop loop;
  loop.configure(rig);  // with a pass of the config's own duration
  rig.duration_s = 2.0 * static_cast<double>(state.max_iterations) * rig.period_s;
  Course course(rig, 1);
  const auto ring = std::make_unique<RecordingRing>();
  const auto own = std::make_unique<TimeHistogram>(), model = std::make_unique<TimeHistogram>();
  std::int64_t tick = 0;
  for (auto _ : state) {
    StageTimes stages;
    course.prefetch();
    ring->prefetch();
    loop.pass(backend, tick, 0, &stages, &MonotonicClock::now_ns);
    ring->push(loop.row());
    course.after(tick++, loop);
    stages.end = MonotonicClock::now_ns();
    own->add(stages.end - stages.written);
    model->add(stages.controlled - stages.read);
    if (tick % 4096 == 0) {
      state.PauseTiming();
      Row row;
      while (ring->pop(row)) {}
      state.ResumeTiming();
    }
  }
  state.counters["own_p50_us"] = own->percentile_us(0.5);
  state.counters["own_p99_us"] = own->percentile_us(0.99);
  state.counters["model_p50_us"] = model->percentile_us(0.5);  // guard, estimator and controller
  state.counters["model_p99.9_us"] = model->percentile_us(0.999);
}
struct LoopCase {
  const char *name, *config;
  std::vector<std::string> sets;
  std::int64_t ticks;
};
const bool loop_ticks_registered = [] {
  const std::vector<std::string> off{"controller.flow_feedforward=off"}, all{"controller.learning=command"};
  for (const LoopCase& one : {LoopCase{"", "cylinder-10m-7.65mm", off, 500'000},
                              LoopCase{", pass and learning", "cylinder-10m-7.65mm", all, 500'000},
                              LoopCase{", modal filter", "cylinder-5m-4.15mm", off, 500'000},
                              LoopCase{", modal filter, pass and learning", "cylinder-5m-4.15mm", all, 500'000},
                              LoopCase{", servo table", "servo-table-0.5m-4mm", {}, 50'000}})
    benchmark::RegisterBenchmark(std::string("loop/tick with recording").append(one.name).c_str(),
                                 [one](benchmark::State& state) { loop_tick(state, one.config, one.sets); })
        ->Iterations(one.ticks);
  return true;
}();

/// A new move from a motion under way, with the set point of its tick: what a command adds to a tick at most.
void re_plan(benchmark::State& state) {
  const Rig rig = read_rig(PNEUSERVO_SOURCE_DIR "/config/served/cylinder-10m-7.65mm.yaml");
  LivePlanner planner;
  planner.configure(live_limits(rig.reference), rig.period_s);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> target_m(rig.reference.lowest_m, rig.reference.highest_m);
  const auto times = std::make_unique<TimeHistogram>();
  std::int64_t tick = 0;
  for (auto _ : state) {
    const double to_m = target_m(random);
    tick += 1 + static_cast<std::int64_t>(random() % 50);
    const std::int64_t begin_ns = MonotonicClock::now_ns();
    planner.pass(tick);
    benchmark::DoNotOptimize(planner.move_to(tick, to_m, rig.reference.speed_mps));
    benchmark::DoNotOptimize(planner.at(tick));
    times->add(MonotonicClock::now_ns() - begin_ns);
  }
  state.counters["p50_us"] = times->percentile_us(0.5);
  state.counters["p99.9_us"] = times->percentile_us(0.999);
}
BENCHMARK(re_plan)->Name("loop/re-plan of a move")->Iterations(1'000'000);

/// What a run of the simulated axis hands to its supervision in a tick.
struct SupervisedTick {
  Measurement measured;
  EstimatorOutput estimate;
  double command_V = 0.0;
  MotionSample motion;
  ControlInput control;
};

std::vector<SupervisedTick> supervised_ticks(const Rig& rig, AxisLoop& loop, std::size_t count) {
  SimBackend backend(rig);
  backend.configure();
  PipelineEstimator estimator;
  estimator.configure(estimator_parameters(rig));
  std::vector<SupervisedTick> ticks(count);
  for (std::size_t i = 0; i < count; ++i) {
    SupervisedTick& t = ticks[i];
    loop.pass(backend, static_cast<std::int64_t>(i), 0, nullptr, nullptr);
    backend.read(static_cast<std::int64_t>(i), t.measured);
    const Row& row = loop.row();
    t.estimate = estimator.step({t.measured.channel[Signal::p1_port].value, t.measured.channel[Signal::p2_port].value,
                                 t.measured.channel[Signal::x].value, row.v_mps, row.u_V});
    t.command_V = row.u_V,
    t.motion = {row.measured[Signal::x], row.x_predicted_m, row.x_ref_m, row.v_mps, row.v_ref_mps, 0.0, 1.0};
    t.control.now = t.control.ahead = loop.reference().at(row.t_s - loop.reference_start_s());
  }
  return ticks;
}

/// All supervision: judging six channels and the digital lines, cross-checks, motion and its prediction, along a period
/// of the reference; `twin_ns` is the prediction's part.
void supervisor_tick(benchmark::State& state) {
  const Rig rig = read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/cylinder-10m-7.65mm.yaml");
  AxisLoop loop;
  loop.configure(rig);
  constexpr int period_ticks = 1000;
  const auto ticks = supervised_ticks(rig, loop, period_ticks);
  MotionPrediction prediction = predict_motion(rig, loop.reference());
  prediction.limits.speed_deviation_mps = MotionLimits::unlimited;  // the reference's speed stands for the prediction's
  Supervisor supervisor;
  supervisor.configure(rig, false, prediction.limits);
  MotionTwin &twin = prediction.twin, alone;
  twin.start(0.0, {rig.initial.pressure_1_Pa, 5.402e5}, {});
  alone = twin;
  std::uint64_t faults = 0;
  const auto [all, predicted] = bench::least_ns(
      period_ticks, 800,
      [&](int k) {
        const SupervisedTick& t = ticks[static_cast<std::size_t>(k)];
        if (k == 0) faults |= supervisor.faults(), supervisor.rearm();
        const JudgedInputs in = supervisor.judge(t.measured, 0);
        supervisor.cross_check(in, t.estimate, 0);
        supervisor.check_motion({t.motion, true, true});
        twin.step(t.control, in.supply_Pa, supervisor.motion().most_command_V());
        supervisor.note_commands({t.command_V, 0.0});
      },
      [&](int k) {
        const SupervisedTick& t = ticks[static_cast<std::size_t>(k)];
        alone.step(t.control, t.measured.channel[Signal::p_supply].value, MotionLimits::unlimited);
      });
  if ((faults | supervisor.faults()) != 0) state.SkipWithError("the supervisor found a fault");
  state.counters["twin_ns"] = predicted;
  bench::report(state, all);
}
BENCHMARK(supervisor_tick)->Name("loop/supervisor")->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

}  // namespace
