// Whole axis: plant, estimator and controller of one tick, and four plants in lanes.
#include <cmath>

#include <pneuservo/control/pd_force.hpp>
#include <pneuservo/estimator/pipeline_estimator.hpp>
#include <pneuservo/rig/plant.hpp>

#include "bench_tools.hpp"
#include "estimator/nominal_estimator.hpp"

namespace pneuservo::bench {
namespace {

constexpr double period_s = 1e-3;

template <class S> AxisPlant<S> started_plant(const AxisParameters<double>& axis, double cells_per_m) {
  AxisPlant<S> plant;
  plant.configure(cast<AxisParameters<S>>(axis), period_s, cells_per_m);
  plant.reset({S(0.0), S(470e3), S(balancing_pressure_2(axis, 470e3))});
  return plant;
}

/// Sine of 80 mm, 1 Hz, a second of it over and over, with its derivatives.
std::vector<ReferencePoint> sine_reference() {
  std::vector<ReferencePoint> points(1000);
  const double w = 6.283185307179586;
  for (std::size_t k = 0; k < points.size(); ++k)
    for (std::size_t i = 0; i < 8; ++i)
      points[k].d[i] = 0.08 * std::pow(w, static_cast<double>(i)) *
                       std::sin(w * static_cast<double>(k) * period_s + 1.5707963267948966 * static_cast<double>(i));
  return points;
}

/// The closed loop without sensors, recording and clock: plant at 1 cell/m, estimator, PD with force feedback.
void whole_axis_tick(benchmark::State& state) {
  const auto axis = nominal_axis();
  auto plant = started_plant<double>(axis, static_cast<double>(state.range(0)));
  PipelineEstimator estimator;
  estimator.configure(test::nominal_estimator(axis));
  PdForceParameters gains;
  gains.position_gain_N_per_m = 7550;
  gains.velocity_gain_Ns_per_m = 95.6;
  gains.force_gain_V_per_N = 0.00572;
  PdForce controller(gains, axis, period_s);
  const auto reference = sine_reference();
  const std::int64_t before = allocations();
  const auto [ns] = least_ns(1000, 600, [&](int k) {
    const auto port = plant.port_pressure();
    const auto estimate = estimator.step({low(port), high(port), plant.position(), plant.velocity()});
    const auto& now = reference[static_cast<std::size_t>(k)];
    plant.step(
        controller.step(plant.position(), estimate.chamber_pressure_Pa[0], estimate.chamber_pressure_Pa[1], now, now));
  });
  if (!(std::fabs(plant.position()) < 0.15)) state.SkipWithError("the axis left its stroke");
  state.counters["allocations"] = static_cast<double>(allocations() - before);
  state.counters["times_real_time"] = period_s * 1e9 / ns;
  report(state, ns);
}
BENCHMARK(whole_axis_tick)
    ->ArgName("cells_per_m")
    ->Arg(1)
    ->Arg(4)
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kNanosecond);

/// Plants alone, their commands given; S carries the plants in lanes.
template <class S> void plants_tick(benchmark::State& state) {
  auto plants = started_plant<S>(nominal_axis(), 1.0);
  const auto reference = sine_reference();
  const auto [ns] =
      least_ns(1000, 600, [&](int k) { plants.step(S(10.0 * reference[static_cast<std::size_t>(k)].d[0])); });
  if (!(std::fabs(lane(plants.position(), 0)) < 0.16)) state.SkipWithError("the axis left its stroke");
  state.counters["plants"] = ScalarTraits<S>::lanes;
  state.counters["plant_seconds_per_second"] = ScalarTraits<S>::lanes * period_s * 1e9 / ns;
  report(state, ns);
}
BENCHMARK(plants_tick<double>)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);
BENCHMARK(plants_tick<Pack<double, 2>>)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);
BENCHMARK(plants_tick<Pack<double, 4>>)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);
BENCHMARK(plants_tick<float>)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

}  // namespace
}  // namespace pneuservo::bench
