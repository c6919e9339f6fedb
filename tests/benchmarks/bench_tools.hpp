// What the benchmarks share: interleaved minimum timing for a noisy machine, count of allocations, the nominal axis.
#pragma once
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>

#include <benchmark/benchmark.h>

#include "rig/nominal_axis.hpp"

namespace pneuservo::bench {

using test::nominal_axis;

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

}  // namespace pneuservo::bench
