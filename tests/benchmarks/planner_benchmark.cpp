// Planning a motion anew at run time: 1 ms, from any state of motion.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <pneuservo/control/live_planner.hpp>

#include "bench_tools.hpp"

namespace pneuservo {
namespace {

/// Random moves, jogs and stops, each at a random tick of the one before; the share that took longest stands beside the
/// median, and neither is a minimum.
void re_plan(benchmark::State& state) {
  constexpr int re_plans = 100'000;
  const LiveLimits limits{
      .lowest_m = -0.12, .highest_m = 0.12, .speed_mps = 0.5, .acceleration_mps2 = 5.0, .smoothness = 7};
  std::mt19937_64 random(1);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  LivePlanner planner;
  planner.configure(limits, 1e-3);
  planner.start(0, 0.0);
  std::vector<double> taken_ns;
  taken_ns.reserve(re_plans);
  const std::int64_t before = bench::allocations();
  std::int64_t tick = 0, refused = 0;
  for (int i = 0; i < re_plans; ++i) {
    tick += static_cast<std::int64_t>(random() % 300);
    planner.pass(tick);
    const double to_m = uniform(-0.12, 0.12), speed = uniform(0.01, 0.5);
    const auto kind = random() % 8;
    const double start = bench::now_ns();
    const bool taken = kind == 0   ? planner.stop(tick)
                       : kind == 1 ? planner.jog(tick, speed)
                                   : planner.move_to(tick, to_m, speed);
    taken_ns.push_back(bench::now_ns() - start);
    refused += taken ? 0 : 1;
  }
  if (bench::allocations() != before) state.SkipWithError("a re-plan allocates");
  std::ranges::sort(taken_ns);
  state.counters["p99.9_ns"] = taken_ns[re_plans - re_plans / 1000];
  state.counters["refused"] = static_cast<double>(refused);
  state.counters["most_ns"] = taken_ns.back();
  bench::report(state, taken_ns[re_plans / 2]);
}
BENCHMARK(re_plan)->Name("planner/re-plan")->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

}  // namespace
}  // namespace pneuservo
