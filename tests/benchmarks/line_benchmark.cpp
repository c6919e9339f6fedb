// Line kernel: cost of a cell and step with 1, 2, 4 and 8 lines in lanes, and how it compares with one scalar line.
#include <cmath>
#include <vector>

#include <pneuservo/elements/wide_line.hpp>

#include "bench_tools.hpp"

namespace pneuservo::bench {
namespace {

constexpr int cells = 10, calls = 2000, batches = 400;

/// A 10 m line between a port pressure that swings and a chamber: flow in both directions, laminar and turbulent.
template <class S> class SwungLine {
 public:
  explicit SwungLine(double frequency_dependent_losses = 0.0) {
    const auto axis = nominal_axis();
    line_.configure(cast<LineParameters<S>>(axis.line_1), cast<AirParameters<S>>(axis.air), cells);
    LineEffects<S> effects;
    effects.frequency_dependent_losses.share = S(frequency_dependent_losses);
    line_.set_effects(effects);
    line_.reset(S(470e3), S(293.0));
    line_.set_time_step(1e-3);
    for (int k = 0; k < calls; ++k) port_Pa_.push_back(470e3 + 20e3 * std::sin(0.02 * k));
  }
  void operator()(int k) noexcept {
    const auto flow = line_.step_prescribed(S(port_Pa_[static_cast<std::size_t>(k)]), {S(470e3), S(293.0)});
    benchmark::DoNotOptimize(flow);
  }

 private:
  Line<S> line_;
  std::vector<double> port_Pa_;
};

template <class S> void line_kernel(benchmark::State& state) {
  SwungLine<double> scalar;
  SwungLine<S> lanes;
  const auto [scalar_ns, lanes_ns] = least_ns(calls, batches, scalar, lanes);
  report(state, lanes_ns);
  state.counters["lines"] = ScalarTraits<S>::lanes;
  state.counters["ns_per_cell_and_step"] = lanes_ns / cells;
  state.counters["ns_per_cell_step_and_line"] = lanes_ns / cells / ScalarTraits<S>::lanes;
  state.counters["ratio_to_scalar_line"] = lanes_ns / scalar_ns;
}
BENCHMARK(line_kernel<double>)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);
BENCHMARK(line_kernel<Pack<double, 2>>)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);
BENCHMARK(line_kernel<Pack<double, 4>>)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);
BENCHMARK(line_kernel<Pack<double, 8>>)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

/// A line whose losses depend on frequency, beside one without; alone, and both lines of an axis in two lanes.
template <class S> void line_with_losses(benchmark::State& state) {
  SwungLine<S> plain, with_losses(1.0);
  const auto [plain_ns, losses_ns] = least_ns(calls, batches, plain, with_losses);
  report(state, losses_ns);
  state.counters["ns_per_cell_and_step"] = losses_ns / cells;
  state.counters["ratio_to_plain_line"] = losses_ns / plain_ns;
}
BENCHMARK(line_with_losses<double>)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);
BENCHMARK(line_with_losses<Pack<double, 2>>)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

}  // namespace
}  // namespace pneuservo::bench
