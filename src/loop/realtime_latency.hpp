// Wake-up latency of the loop's own timer: the loop's session, clock and grid with nothing in the ticks.
#pragma once
#include <memory>

#include <pneuservo/loop/timing.hpp>

#include "loop/realtime.hpp"

namespace pneuservo {

struct LatencySettings {
  RealTimeSettings session;
  std::int64_t period_ns = 1'000'000;
  double duration_s = 10.0;
};

/// `timing.lateness` is wake-up against the ideal grid, `timing.loop` the bookkeeping of a tick, `overruns` the slots
/// that were skipped; faults and preemptions are counted from the eleventh tick on.
struct LatencyResult {
  std::string name;
  std::int64_t period_ns = 0;
  LoopTiming timing;
  RealTimeState state;
  std::vector<Finding> findings;
};

/// Measures until `duration_s` is over or a stop is requested.
std::unique_ptr<LatencyResult> measure_latency(const LatencySettings& settings);

}  // namespace pneuservo
