// The whole loop for the proofs: simulated plant, guard, estimator, controller, recording ring and course, as in
// run_loop.
#pragma once
#include <string>

#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/record/ring.hpp>

#include "config/read_rig.hpp"
#include "loop/course.hpp"
#include "loop/realtime_clock.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {

/// One tick is what real time does between two sleeps.
class WholeLoop {
 public:
  /// `source`: a word of pressure_source_names.
  WholeLoop(const std::string& source, bool feedforward)
      : rig_(read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/cylinder-10m-7.65mm.yaml",
                      {"controller.pressure_source=" + source, "initial.position_m=0.02", "duration_s=1.5",
                       std::string("controller.flow_feedforward=") + (feedforward ? "true" : "false")})),
        backend_(rig_), course_(rig_, moves) {
    loop_.configure(rig_);
    backend_.configure();
    backend_.activate();
  }

  /// Every 97th tick comes late and skips three slots. False: the run is over.
  bool tick() noexcept {
    const std::int64_t skipped = tick_ % 97 == 96 ? 3 : 0;
    tick_ += skipped;
    const RtScope hot;
    StageTimes stages;
    course_.prefetch();
    ring_.prefetch();
    loop_.pass(backend_, tick_, skipped, &stages, &MonotonicClock::now_ns);
    ring_.push(loop_.row());
    ++tick_;
    return course_.after(tick_ - 1, loop_);
  }
  /// The consumer's part, outside the section.
  void drain() noexcept {
    Row row;
    while (ring_.pop(row)) {}
  }
  /// Ends it with the safe output, as a stop request does.
  void stop() noexcept {
    const RtScope hot;
    loop_.stop(backend_, tick_);
  }
  const AxisLoop& loop() const noexcept { return loop_; }

 private:
  static constexpr int moves = 6;
  Rig rig_;
  SimBackend backend_;
  AxisLoop loop_;
  Course course_;
  RecordingRing ring_;
  std::int64_t tick_ = 0;
};

}  // namespace pneuservo
