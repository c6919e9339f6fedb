// Estimator: cost of a tick (both lines, both chambers, shadow pair), its tail over a million ticks, its allocations.
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <x86intrin.h>

#include <pneuservo/estimator/pipeline_estimator.hpp>
#include <pneuservo/loop/axis_loop.hpp>

#include "bench_tools.hpp"
#include "config/read_rig.hpp"
#include "estimator/nominal_estimator.hpp"

namespace pneuservo::bench {
namespace {

using test::nominal_estimator;

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

void estimator_tick(benchmark::State& state, bool with_losses) {
  EstimatorParameters parameters = nominal_estimator();
  parameters.effects.frequency_dependent_losses.share = 1.0;
  parameters.frequency_dependent_losses = with_losses;
  PipelineEstimator estimator;
  estimator.configure(parameters);
  const auto inputs = swung_inputs();
  const std::int64_t before = allocations();
  const auto [ns] = least_ns(1000, 800, [&](int k) {
    const auto out = estimator.step(inputs[static_cast<std::size_t>(k)]);
    benchmark::DoNotOptimize(out);
  });
  state.counters["allocations"] = static_cast<double>(allocations() - before);
  report(state, ns);
}
void estimator_tick(benchmark::State& state) { estimator_tick(state, false); }
BENCHMARK(estimator_tick)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);
void estimator_tick_with_losses(benchmark::State& state) { estimator_tick(state, true); }
BENCHMARK(estimator_tick_with_losses)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

/// A row of a million of swung_inputs as columns, with the config that tools/python-figures takes, the results as
/// columns.
void estimator_rows(benchmark::State& state) {
  constexpr std::size_t rows = 1'000'000, results = 7;
  PipelineEstimator estimator;
  estimator.configure(estimator_parameters(read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-10m-7.65mm.yaml")));
  const auto inputs = swung_inputs();
  std::array<std::vector<double>, 4> columns;
  for (std::size_t i = 0; i < rows; ++i) {
    const EstimatorInput& in = inputs[i % inputs.size()];
    const std::array values{in.p1_port_Pa, in.p2_port_Pa, in.x_m, in.v_mps};
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c].push_back(values[c]);
  }
  const auto [ns] = least_ns(1, 5, [&](int) {
    std::array<std::vector<double>, results> out;
    for (auto& column : out) column.resize(rows);
    for (std::size_t i = 0; i < rows; ++i) {
      const EstimatorOutput e = estimator.step({columns[0][i], columns[1][i], columns[2][i], columns[3][i], 0.0, 0.0});
      for (std::size_t side = 0; side < 2; ++side) {
        const auto at = static_cast<Eigen::Index>(side);
        out[side][i] = e.chamber_pressure_Pa[at];
        out[2 + side][i] = e.error_bound_Pa[at];
        out[4 + side][i] = e.mass_flow_kgps[at];
      }
      out[6][i] = e.health;
    }
    benchmark::DoNotOptimize(out);
  });
  report(state, ns / rows);
}
BENCHMARK(estimator_rows)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

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
    const double ports[4] = {in.p1_port_Pa, in.p2_port_Pa, in.p1_port_Pa + 100.0, in.p2_port_Pa - 100.0};
    model.step(P::load(ports), in.x_m);
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

/// Times of a million turns, each between two reads of the time stamp counter.
class Turns {
 public:
  static constexpr int count = 1'000'000;

  explicit Turns(double period_ns) : period_ns_(period_ns), spent_(count) {}
  template <class Work> void time(int k, Work&& work) {
    unsigned core;
    const auto start = __rdtscp(&core);
    work(k);
    spent_[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(__rdtscp(&core) - start);
  }
  double mean_ns() const { return std::accumulate(spent_.begin(), spent_.end(), 0.0) / count * period_ns_; }
  void sort() { std::sort(spent_.begin(), spent_.end()); }
  /// Of sorted times.
  double percentile_ns(double share) const {
    return spent_[static_cast<std::size_t>(share * (count - 1))] * period_ns_;
  }

 private:
  double period_ns_;
  std::vector<std::uint32_t> spent_;
};

/// A million ticks, and after each a turn about as long that lives in one register: what the machine itself makes of a
/// tail (its interrupts, mostly) meets both alike. Percentiles include the reads of the counter.
void estimator_tail(benchmark::State& state) {
  PipelineEstimator estimator;
  estimator.configure(nominal_estimator());
  const auto inputs = swung_inputs();
  const double period_ns = counter_period_ns();
  Turns ticks(period_ns), machine(period_ns);
  const std::int64_t before = allocations();
  for (int k = 0; k < Turns::count; ++k) {
    ticks.time(k, [&](int at) {
      const auto out = estimator.step(inputs[static_cast<std::size_t>(at % 1000)]);
      benchmark::DoNotOptimize(out);
    });
    machine.time(k, [](int) {
      double x = 1.0;
      for (int i = 0; i < 230; ++i) {
        x *= 0.999;
        asm volatile("" : "+x"(x));  // stays in its register, and stays
      }
    });
  }
  state.counters["allocations"] = static_cast<double>(allocations() - before);
  const double mean_ns = ticks.mean_ns();
  ticks.sort();
  machine.sort();
  state.counters["mean_ns"] = mean_ns;
  state.counters["p50_ns"] = ticks.percentile_ns(0.5);
  state.counters["p99_ns"] = ticks.percentile_ns(0.99);
  state.counters["p99_99_ns"] = ticks.percentile_ns(0.9999);
  state.counters["max_ns"] = ticks.percentile_ns(1.0);
  state.counters["machine_p50_ns"] = machine.percentile_ns(0.5);
  state.counters["machine_p99_99_ns"] = machine.percentile_ns(0.9999);
  state.counters["machine_max_ns"] = machine.percentile_ns(1.0);
  report(state, mean_ns);
}
BENCHMARK(estimator_tail)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

}  // namespace
}  // namespace pneuservo::bench
