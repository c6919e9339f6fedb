// Wake-up latency of the loop's own timer.
#include "loop/realtime_latency.hpp"

#include <pneuservo/loop/grid.hpp>

#include "loop/realtime_clock.hpp"
#include "loop/realtime_stop.hpp"

namespace pneuservo {
namespace {

constexpr std::int64_t untimed_ticks = 10;

// The bookkeeping that every tick of the loop has.
void account(LoopTiming& timing, std::int64_t tick, std::int64_t lateness_ns, std::int64_t work_ns) noexcept {
  timing.lateness.add(lateness_ns);
  timing.loop.add(work_ns);
  timing.keep_worst({tick, lateness_ns, work_ns});
}

}  // namespace

std::unique_ptr<LatencyResult> measure_latency(const LatencySettings& settings) {
  auto result = std::make_unique<LatencyResult>();
  result->name = "timer";
  result->period_ns = settings.period_ns;
  prefault(result.get(), sizeof *result);
  RealTimeSession session(settings.session);
  result->state = session.state();
  result->findings = session.findings();

  LoopTiming& timing = result->timing;
  const auto ticks = static_cast<std::int64_t>(settings.duration_s * 1e9 / static_cast<double>(settings.period_ns));
  TimeGrid grid(MonotonicClock::now_ns() + settings.period_ns, settings.period_ns);
  ThreadCounters before = ThreadCounters::now();
  std::int64_t work_ns = 0;
  while (grid.slot() < ticks && !StopRequest::requested()) {
    MonotonicClock::sleep_until_ns(grid.slot_ns());
    const std::int64_t woken_ns = MonotonicClock::now_ns();
    account(timing, grid.slot(), grid.lateness_ns(woken_ns), work_ns);
    if (++timing.ticks == untimed_ticks) before = ThreadCounters::now();
    const std::int64_t done_ns = MonotonicClock::now_ns();
    work_ns = done_ns - woken_ns;
    timing.overruns += grid.advance(done_ns);
  }
  const ThreadCounters counted = ThreadCounters::now() - before;
  timing.page_faults = counted.page_faults;
  timing.context_switches_involuntary = counted.context_switches_involuntary;
  return result;
}

}  // namespace pneuservo
