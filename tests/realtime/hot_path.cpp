// Uses of everything that runs in a tick, for tools/check-realtime: clang-tidy follows each call to its end. Templates
// are only seen where they are used, so each belongs here with the types that the loop gives it.
#include <pneuservo/control/spool_loop.hpp>
#include <pneuservo/core/dual.hpp>
#include <pneuservo/core/rt.hpp>
#include <pneuservo/estimator/pipeline_estimator.hpp>
#include <pneuservo/loop/grid.hpp>
#include <pneuservo/loop/input_guard.hpp>
#include <pneuservo/loop/timing.hpp>
#include <pneuservo/record/ring.hpp>

namespace pneuservo {

void hot_bookkeeping(LoopTiming& timing, TimeGrid& grid, std::int64_t woken_ns,
                     std::int64_t done_ns) noexcept PNEUSERVO_NONBLOCKING {
  const RtScope scope;
  timing.lateness.add(grid.lateness_ns(woken_ns));
  timing.loop.add(done_ns - woken_ns);
  timing.keep_worst({grid.slot(), grid.lateness_ns(woken_ns), done_ns - woken_ns});
  timing.overruns += grid.advance(done_ns);
}

double hot_scalars(double x) noexcept PNEUSERVO_NONBLOCKING {
  using P = Pack<double, 4>;
  const P a(x), b = a * P(2.0) + square_root(absolute(a));
  const P c = select(a < b, minimum(a, b), b / a);
  return c[0] + c[3] + exponential(x) + sine(x);
}

double hot_guard(InputGuard& guard, const Channel& channel) noexcept PNEUSERVO_NONBLOCKING {
  return guard.check(channel);
}

double hot_estimator(PipelineEstimator& estimator, const EstimatorInput& input) noexcept PNEUSERVO_NONBLOCKING {
  return estimator.step(input).chamber_pressure_Pa[0];
}

double hot_spool_loop(SpoolLoop& loop, const SpoolLoopGains& gains, double x_m) noexcept PNEUSERVO_NONBLOCKING {
  loop.change(gains);
  return loop.step(x_m, 0.0);
}

void hot_last_rows(LastRows& last, const Row& row) noexcept PNEUSERVO_NONBLOCKING {
  last.prefetch(7);
  last.keep(7, row);
}

}  // namespace pneuservo
