// The motion that commands ask for while an axis is active.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <pneuservo/control/live_planner.hpp>
#include <pneuservo/loop/approach.hpp>
#include <pneuservo/loop/axis_command.hpp>

namespace pneuservo {

/// Commands into plans. Until the start is proven moves go as slowly as an approach. All of it but configure is HOT.
class CommandedMotion {
 public:
  void configure(const LiveLimits& limits, double period_s) noexcept { planner_.configure(limits, period_s); }
  /// Rests there.
  void start(std::int64_t tick, double position_m) noexcept {
    planner_.start(tick, position_m);
    moving_ = held_ = false;
    proven_ = false;
    jogs_ = false;
  }
  /// False: the planner has no room yet; ask again in the next tick. Else `result` says what became of it.
  bool obey(const AxisCommand& command, std::int64_t tick, CommandResult& result) noexcept {
    result = CommandResult::taken;
    switch (command.kind) {
      case CommandKind::move_to: return move(command.position_m, command.speed_mps, tick, result);
      case CommandKind::move_by:
        return move((jogs_ ? planner_.at(tick).d[0] : planner_.target_m()) + command.position_m, command.speed_mps,
                    tick, result);
      case CommandKind::jog: return jog(command.speed_mps, tick);
      case CommandKind::hold:
        if (!stop(tick)) return false;
        held_ = moving_;
        return true;
      case CommandKind::resume:
        if (!held_) result = CommandResult::nothing_held;
        return !held_ || move(wanted_m_, wanted_mps_, tick, result);
      default:
        if (!stop(tick)) return false;
        moving_ = held_ = jogs_ = false;
        return true;
    }
  }
  /// Once a tick, before the set points. From the proof of the start on moves have their full speed.
  void pass(std::int64_t tick, bool proven) noexcept {
    planner_.pass(tick);
    if (proven && !proven_) proven_ = held_ || !moving_ || planner_.move_to(tick, wanted_m_, wanted_mps_);
    moving_ = moving_ && (held_ || tick < planner_.end_tick());
  }
  ReferencePoint at(std::int64_t tick, double ahead) const noexcept { return planner_.at(tick, ahead); }
  const LivePlanner& planner() const noexcept { return planner_; }

 private:
  double held(double speed_mps) const noexcept {
    return proven_ ? speed_mps : std::min(speed_mps, Approach::speed_mps);
  }
  bool move(double target_m, double speed_mps, std::int64_t tick, CommandResult& result) noexcept {
    const LiveLimits& limits = planner_.limits();
    if (!(target_m >= limits.lowest_m && target_m <= limits.highest_m)) {
      result = CommandResult::outside;
      return true;
    }
    if (!planner_.move_to(tick, target_m, held(speed_mps))) return false;
    wanted(target_m, speed_mps);
    jogs_ = false;
    return true;
  }
  bool jog(double speed_mps, std::int64_t tick) noexcept {
    if (!planner_.jog(tick, std::copysign(held(std::fabs(speed_mps)), speed_mps))) return false;
    wanted(planner_.target_m(), std::fabs(speed_mps));
    jogs_ = true;
    return true;
  }
  bool stop(std::int64_t tick) noexcept { return planner_.stop(tick); }
  void wanted(double target_m, double speed_mps) noexcept {
    wanted_m_ = target_m;
    wanted_mps_ = speed_mps;
    moving_ = true;
    held_ = false;
  }

  LivePlanner planner_;
  bool proven_ = false, moving_ = false, held_ = false, jogs_ = false;
  double wanted_m_ = 0.0, wanted_mps_ = 0.0;
};

}  // namespace pneuservo
