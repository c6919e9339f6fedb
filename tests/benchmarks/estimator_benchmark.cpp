// Estimator: cost of a tick (both lines, both chambers, shadow pair), its tail over a million ticks, its allocations.
#include <cmath>
#include <vector>

#include <x86intrin.h>

#include <pneuservo/estimator/pipeline_estimator.hpp>

#include "bench_tools.hpp"

namespace pneuservo::bench {
namespace {

EstimatorParameters nominal_estimator() {
  const auto axis = nominal_axis();
  EstimatorParameters p;
  p.air = axis.air;
  p.supply_pressure_Pa = axis.supply.pressure_Pa;
  p.line_1 = axis.line_1;
  p.line_2 = axis.line_2;
  p.cylinder = axis.cylinder;
  return p;
}

/// Inputs of a 1 Hz motion with swinging ports, a second of them over and over.
std::vector<EstimatorInput> swung_inputs() {
  std::vector<EstimatorInput> inputs;
  for (int k = 0; k < 1000; ++k) {
    const double angle = 6.283185307179586 * k * 1e-3;
    inputs.push_back({480e3 + 40e3 * std::sin(angle), 550e3 - 40e3 * std::cos(angle), 0.08 * std::sin(angle),
                      0.5 * std::cos(angle)});
  }
  return inputs;
}

void estimator_tick(benchmark::State& state) {
  PipelineEstimator estimator;
  estimator.configure(nominal_estimator());
  const auto inputs = swung_inputs();
  const std::int64_t before = allocations();
  const auto [ns] = least_ns(1000, 800, [&](int k) {
    const auto out = estimator.step(inputs[static_cast<std::size_t>(k)]);
    benchmark::DoNotOptimize(out);
  });
  state.counters["allocations"] = static_cast<double>(allocations() - before);
  report(state, ns);
}
BENCHMARK(estimator_tick)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

/// Lines and chambers of the estimator alone, in four lanes.
void estimator_model(benchmark::State& state) {
  using P = Pack<double, 4>;
  const auto axis = nominal_axis();
  AxisEstimator<P> model;
  const double areas[4] = {1.257e-3, 1.056e-3, 1.257e-3, 1.056e-3}, signs[4] = {1.0, -1.0, 1.0, -1.0};
  model.configure(cast<LineParameters<P>>(axis.line_1), {P::load(areas), P(2e-5), P(50.0)},
                  cast<AirParameters<P>>(axis.air), P(0.15), P::load(signs), 1e-3, 10);
  model.reset(P(470e3), 0.0);
  const auto inputs = swung_inputs();
  const auto [ns] = least_ns(1000, 800, [&](int k) {
    const auto& in = inputs[static_cast<std::size_t>(k)];
    const double ports[4] = {in.port_pressure_1_Pa, in.port_pressure_2_Pa, in.port_pressure_1_Pa + 100.0,
                             in.port_pressure_2_Pa - 100.0};
    model.step(P::load(ports), in.position_m);
    benchmark::ClobberMemory();
  });
  report(state, ns);
}
BENCHMARK(estimator_model)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

/// Nanoseconds of a tick of the time stamp counter.
double counter_period_ns() {
  const double start_ns = now_ns();
  const auto start = __rdtsc();
  while (now_ns() - start_ns < 50e6) {}
  const auto end = __rdtsc();
  return (now_ns() - start_ns) / static_cast<double>(end - start);
}

/// A million turns of work(k), each between two reads of the time stamp counter; percentiles include the reads and
/// whatever else the machine did meanwhile.
template <class Work> void report_tail(benchmark::State& state, Work&& work) {
  constexpr int turns = 1'000'000;
  std::vector<std::uint32_t> spent(turns);
  const double period_ns = counter_period_ns();
  const std::int64_t before = allocations();
  unsigned core;
  for (int k = 0; k < turns; ++k) {
    const auto start = __rdtscp(&core);
    work(k);
    spent[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(__rdtscp(&core) - start);
  }
  state.counters["allocations"] = static_cast<double>(allocations() - before);
  double sum = 0.0;
  for (const auto one : spent) sum += one;
  std::sort(spent.begin(), spent.end());
  const auto percentile_ns = [&](double share) {
    return spent[static_cast<std::size_t>(share * (turns - 1))] * period_ns;
  };
  state.counters["mean_ns"] = sum / turns * period_ns;
  state.counters["p50_ns"] = percentile_ns(0.5);
  state.counters["p99_ns"] = percentile_ns(0.99);
  state.counters["p99_99_ns"] = percentile_ns(0.9999);
  state.counters["max_ns"] = percentile_ns(1.0);
  report(state, sum / turns * period_ns);
}

void estimator_tail(benchmark::State& state) {
  PipelineEstimator estimator;
  estimator.configure(nominal_estimator());
  const auto inputs = swung_inputs();
  report_tail(state, [&](int k) {
    const auto out = estimator.step(inputs[static_cast<std::size_t>(k % 1000)]);
    benchmark::DoNotOptimize(out);
  });
}
BENCHMARK(estimator_tail)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

/// What the machine itself makes of a tail: about as long a turn that lives in one register.
void machine_tail(benchmark::State& state) {
  double x = 1.0;
  report_tail(state, [&](int) {
    for (int i = 0; i < 640; ++i) benchmark::DoNotOptimize(x *= 0.999);
    x = 1.0;
  });
}
BENCHMARK(machine_tail)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

}  // namespace
}  // namespace pneuservo::bench
