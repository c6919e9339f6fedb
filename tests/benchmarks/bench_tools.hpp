// What the benchmarks share: interleaved minimum timing for a noisy machine, count of allocations, the nominal axis.
#pragma once
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>

#include <benchmark/benchmark.h>

#include <pneuservo/rig/axis.hpp>

namespace pneuservo::bench {

/// Calls of operator new so far (bench_main.cpp counts them).
std::int64_t allocations() noexcept;

inline double now_ns() noexcept {
  return static_cast<double>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
          .count());
}

/// Shortest time of one call [ns] of each candidate: they take turns in short batches, so that all meet the same
/// disturbances, and the best batch of many stands for the undisturbed machine.
template <class... F> std::array<double, sizeof...(F)> least_ns(int calls, int batches, F&&... candidate) {
  std::array<double, sizeof...(F)> least;
  least.fill(std::numeric_limits<double>::infinity());
  for (int batch = 0; batch < batches; ++batch) {
    std::size_t i = 0;
    const auto run = [&](auto& f) {
      const double start = now_ns();
      for (int k = 0; k < calls; ++k) f(k);
      least[i] = std::min(least[i], (now_ns() - start) / calls);
      ++i;
    };
    (run(candidate), ...);
  }
  return least;
}

/// Reports a time measured by least_ns as the benchmark's own.
inline void report(benchmark::State& state, double ns) {
  for (auto _ : state) state.SetIterationTime(ns * 1e-9);
}

/// Nominal cylinder axis (docs/physics): 10 m lines of 7.65 mm.
inline AxisParameters<double> nominal_axis(double length_m = 10.0, double diameter_m = 0.00765) {
  AxisParameters<double> axis;
  axis.supply.pressure_Pa = 700e3;
  axis.valve.command_max_V = 5.0;
  axis.valve.area_per_volt_m2_per_V = 2.6e-6;
  axis.valve.area_max_m2 = 1.3e-5;
  axis.valve.critical_pressure_ratio = 0.35;
  axis.line_1.length_m = axis.line_2.length_m = length_m;
  axis.line_1.diameter_m = axis.line_2.diameter_m = diameter_m;
  axis.cylinder.stroke_m = 0.3;
  axis.cylinder.area_1_m2 = 1.257e-3;
  axis.cylinder.area_2_m2 = 1.056e-3;
  axis.cylinder.dead_volume_1_m3 = axis.cylinder.dead_volume_2_m3 = 2e-5;
  axis.cylinder.wall_heat_W_per_m2K = 50.0;
  axis.slider.mass_kg = 2.0;
  axis.slider.viscous_friction_Ns_per_m = 60.0;
  return axis;
}

}  // namespace pneuservo::bench
