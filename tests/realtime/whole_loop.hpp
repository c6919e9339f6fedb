// The whole loop for the proofs: simulated plant, guard, estimator, controller, recording ring and course, as in
// run_loop.
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <pneuservo/loop/control_loop.hpp>
#include <pneuservo/record/ring.hpp>

#include "config/read_rig.hpp"
#include "loop/course.hpp"
#include "loop/realtime_clock.hpp"
#include "loop/runner.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {

/// A loop to prove: its config under config/ and what is set beside it.
struct LoopCase {
  std::string name, config;
  std::vector<std::string> sets;
};

/// Each pressure source of a cylinder without feedforward, with that of the formula and with that of a pass, the servo
/// table with linear feedforward and with flatness, learning between its moves, and a cylinder and a pressure that are
/// commanded twenty times a second or rest and move again.
inline std::vector<LoopCase> loop_cases() {
  std::vector<LoopCase> cases;
  for (const std::string source : {"valve", "chamber", "estimated"})
    for (const auto& [feedforward, words] :
         {std::pair{"off", ""}, {"formula", " with feedforward"}, {"pass", " with a pass"}})
      cases.push_back({source + words,
                       "cylinder-10m-7.65mm",
                       {"controller.pressure_source=" + source, "initial.position_m=0.02", "duration_s=1.5",
                        std::string("controller.flow_feedforward=") + feedforward}});
  const std::string move =
      "reference={kind: waypoints, times_s: [0.0, 0.2], positions_m: [-0.05, -0.0499], smoothness: 9}";
  for (const std::string feedforward : {"7", "flatness"})
    cases.push_back({"servo table, feedforward " + feedforward,
                     "servo-table-0.5m-4mm",
                     {move, "duration_s=0.3", "initial.position_m=-0.0495", "simulation.cells_per_m=16",
                      "controller.integral_gain_V_per_m_s=1e4", "controller.learning=flow",
                      "controller.feedforward=" + feedforward}});
  for (const std::string feedforward : {"formula", "pass"})
    cases.push_back(
        {"commanded, feedforward " + feedforward,
         "served/cylinder-10m-7.65mm",
         {"initial.position_m=0.02", "reference.pass_within_s=0.02", "controller.flow_feedforward=" + feedforward}});
  cases.push_back({"commanded pressure", "served/pressure-3m-4mm", {}});
  return cases;
}

/// One tick is what real time does between two sleeps.
class WholeLoop {
 public:
  explicit WholeLoop(const LoopCase& one)
      : rig_(read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/" + one.config + ".yaml", one.sets)), backend_(rig_),
        made_(make_control_loop(rig_, {}, &gains_, is_commanded() ? link_.get() : nullptr)),
        course_(rig_, is_commanded() ? 0 : moves) {
    backend_.configure();
    backend_.activate();
    if (loop_.makes_passes()) maker_ = std::jthread([this](const std::stop_token& ends) { make_passes(ends); });
  }

  /// Every 97th tick comes late and skips three slots. False: the run, or the time of a commanded axis, is over.
  bool tick() {
    const std::int64_t skipped = tick_ % 97 == 96 ? 3 : 0;
    tick_ += skipped;
    if (loop_.learning_due()) loop_.learn(rig_.axis);
    while (loop_.pass_due() || makes_pass_) {}
    if (is_commanded()) command();
    if (tick_ % 1000 == 0) gains_.post(gain_set(rig_.controller.of<Ppd2>()));
    const RtScope hot;
    StageTimes stages;
    course_.prefetch();
    ring_.prefetch();
    loop_.pass(backend_, tick_, skipped, &stages, &MonotonicClock::now_ns);
    ring_.push(loop_.row());
    ++tick_;
    return course_.after(tick_ - 1, loop_) && !(is_commanded() && tick_ >= commanded_ticks);
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
  const ControlLoop& loop() const noexcept { return loop_; }

 private:
  static constexpr int moves = 6;
  static constexpr std::int64_t commanded_ticks = 12000;  // 240 commands; such an axis runs until told otherwise
  /// Beside the loop, as in run_loop; the loop awaits it, for its ticks take no time.
  void make_passes(const std::stop_token& ends) {
    for (; !ends.stop_requested(); std::this_thread::yield()) {
      if (!loop_.pass_due()) continue;
      makes_pass_ = true;
      loop_.make_pass();
      makes_pass_ = false;
    }
  }
  bool is_commanded() const noexcept {
    return rig_.controls_pressure() ? rig_.pressure_reference.kind == PressureReferenceKind::live
                                    : rig_.reference.kind == ReferenceKind::live;
  }
  /// What stands beside the loop: the edge of enable, then moves to and fro that replace each other on their way, a
  /// rest, and one that is stopped on its way.
  void command() {
    for (AxisAnswer answer; link_->answers.pop(answer);) {}
    for (AxisStatus status; link_->status.take(status);) {}
    const double share = static_cast<double>(asked_ * 7 % 11 - 5) / 5.0;
    const double target = rig_.controls_pressure() ? 4e5 + 1e5 * share : 0.1 * share;
    const double rate = rig_.controls_pressure() ? 7e4 : 0.3;
    if (tick_ / 50 < asked_) return;
    const std::int64_t phase = asked_ % 40;
    const bool moves_on = phase < 13 || phase == 32;
    link_->commands.push(asked_ == 0                 ? AxisCommand{CommandKind::enable}
                         : phase == 0 || phase == 13 ? AxisCommand{CommandKind::stop}
                         : moves_on                  ? AxisCommand{CommandKind::move_to, target, rate}
                                                     : AxisCommand{CommandKind::mark});
    ++asked_;
  }
  Rig rig_;
  SimBackend backend_;
  GainMailbox gains_;
  std::unique_ptr<CommandLink> link_ = std::make_unique<CommandLink>();
  std::unique_ptr<ControlLoop> made_;
  ControlLoop& loop_ = *made_;
  Course course_;
  RecordingRing ring_;
  std::int64_t tick_ = 0, asked_ = 0;
  std::atomic<bool> makes_pass_{false};
  std::jthread maker_;  // ends before all else
};

}  // namespace pneuservo
