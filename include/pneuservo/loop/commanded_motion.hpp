// The motion that commands ask for while an axis is active.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <pneuservo/control/live_planner.hpp>
#include <pneuservo/control/set_point_stream.hpp>
#include <pneuservo/loop/approach.hpp>
#include <pneuservo/loop/axis_command.hpp>

namespace pneuservo {

/// What the planner was told last.
struct PlannedMove {
  std::uint64_t number = 0;  ///< another one with each change of the plan
  bool from_rest = false;    ///< to a known target, and nothing moves before it begins
  std::int64_t begin_tick = 0;  ///< the last in which the set point rests; from here on of moves from rest
  double from_m = 0.0, to_m = 0.0, speed_mps = 0.0;
};

/// Commands into plans, set points of a stream into one motion; in Pa in place of m where a pressure is commanded.
/// Until the start is proven moves go as slowly as an approach. A stream takes over from the planner at rest and gives
/// back at rest; commands in between are obeyed by the stream's own line. All of it but configure is HOT.
class CommandedMotion {
 public:
  /// `lead_s`: how far ahead the law looks; `wait_s`: how long a move from rest waits for its begin, once the start is
  /// proven.
  void configure(const LiveLimits& limits, double period_s, double lead_s, double wait_s = 0.0) {
    planner_.configure(limits, period_s);
    wait_ = std::llround(wait_s / period_s);
    stream_.configure(limits, period_s, lead_s);
    period_s_ = period_s;
  }
  /// Rests there.
  void start(std::int64_t tick, double position_m) noexcept {
    planner_.start(tick, position_m);
    moving_ = held_ = false;
    planned_.from_rest = false;
    ++planned_.number;
    proven_ = false;
    jogs_ = streams_ = comes_ = false;
  }
  /// False: the planner has no room yet; ask again in the next tick. Else `result` says what became of it. The line
  /// of the planner jumps at the tick before: that set point has gone out, the one of `tick` is the first to change.
  bool obey(const AxisCommand& command, std::int64_t tick, CommandResult& result) noexcept {
    result = CommandResult::taken;
    if (command.kind != CommandKind::follow) comes_ = false;
    switch (command.kind) {
      case CommandKind::move_to: return move(command.target, command.rate, tick, result);
      case CommandKind::move_by:
        return move((jogs_ ? at(tick - 1).d[0] : target_m()) + command.target, command.rate, tick, result);
      case CommandKind::jog: return jog(command.rate, tick);
      case CommandKind::hold:
        if (!stop(tick)) return false;
        held_ = moving_;
        return true;
      case CommandKind::resume:
        if (!held_) result = CommandResult::nothing_held;
        return !held_ || move(wanted_m_, wanted_mps_, tick, result);
      case CommandKind::follow: return follow(command, tick, result);
      default:
        if (!stop(tick)) return false;
        moving_ = held_ = jogs_ = false;
        return true;
    }
  }
  /// Once a tick, before commands. From the proof of the start on moves have their full speed.
  void pass(std::int64_t tick, bool proven) noexcept {
    planner_.pass(tick);
    if (proven && !proven_) proven_ = held_ || !moving_ || streams_ || replan(tick, wanted_m_, wanted_mps_);
    moving_ = moving_ && (held_ || tick < end_tick());
    if (comes_ && tick > planner_.end_tick()) begin_stream(tick);
  }
  /// Once a tick, after commands: the set point of the tick.
  void advance(std::int64_t tick) noexcept {
    if (!streams_) return;
    stream_.advance(tick, proven_ ? planner_.limits().speed_mps : Approach::speed_mps);
    if (!stream_.rests()) return;
    planner_.start(tick, stream_.target_m());
    streams_ = false;
  }
  /// Of the tick of the last advance(), and ahead of it by nothing or by the law's lead (in periods).
  ReferencePoint at(std::int64_t tick, double ahead = 0.0) const noexcept {
    if (!streams_) return planner_.at(tick, ahead);
    return ahead > 0.0 ? stream_.ahead() : stream_.now();
  }
  double target_m() const noexcept { return streams_ ? stream_.target_m() : planner_.target_m(); }
  /// Tick from which on the set point rests.
  std::int64_t end_tick() const noexcept { return streams_ ? stream_.end_tick() : planner_.end_tick(); }
  /// The set points of a stream are faster than the limits.
  bool is_late() const noexcept { return streams_ && stream_.is_late(); }
  const LivePlanner& planner() const noexcept { return planner_; }
  const PlannedMove& planned() const noexcept { return planned_; }
  const SetPointStream& stream() const noexcept { return stream_; }

 private:
  double held(double speed_mps) const noexcept {
    return proven_ ? speed_mps : std::min(speed_mps, Approach::speed_mps);
  }
  bool is_inside(double target_m) const noexcept {
    return target_m >= planner_.limits().lowest_m && target_m <= planner_.limits().highest_m;
  }
  bool move(double target_m, double speed_mps, std::int64_t tick, CommandResult& result) noexcept {
    if (!is_inside(target_m)) {
      result = CommandResult::outside;
      return true;
    }
    if (streams_) stream_.go_at(target_m, held(speed_mps));
    else if (!replan(tick - 1, target_m, held(speed_mps))) return false;
    wanted(target_m, speed_mps);
    jogs_ = false;
    return true;
  }
  bool jog(double speed_mps, std::int64_t tick) noexcept {
    const LiveLimits& limits = planner_.limits();
    const double speed = held(std::fabs(speed_mps));
    if (streams_) stream_.go_at(speed_mps > 0.0 ? limits.highest_m : limits.lowest_m, speed);
    else if (!planner_.jog(tick - 1, std::copysign(speed, speed_mps))) return false;
    else plan_changed();
    wanted(target_m(), std::fabs(speed_mps));
    jogs_ = true;
    return true;
  }
  bool stop(std::int64_t tick) noexcept {
    if (streams_) stream_.halt();
    if (streams_ || tick > planner_.end_tick()) return true;  // rests, and nothing waits
    if (!planner_.stop(tick - 1)) return false;
    plan_changed();
    return true;
  }
  // From the tick on, or from rest later: what the move needs is made meanwhile. One that takes the place of another
  // that waits begins when that would have: commands in quick succession must not keep the axis where it is.
  bool replan(std::int64_t tick, double target_m, double speed_mps) noexcept {
    const bool waits = wait_ > 0 && proven_ && planner_.rests(tick + 1);
    const bool waited = waits && planned_.from_rest && planned_.begin_tick > tick;
    if (waited && target_m == planned_.to_m && speed_mps == planned_.speed_mps) return true;
    const double from_m = planner_.at(tick).d[0];
    const std::int64_t begin_tick = waited ? planned_.begin_tick : waits ? tick + wait_ : tick;
    if (waited) planner_.stop(tick);
    if (!planner_.move_to(begin_tick, target_m, speed_mps)) return false;
    planned_ = {planned_.number + 1, waits && target_m != from_m, begin_tick, from_m, target_m, speed_mps};
    return true;
  }
  void plan_changed() noexcept {
    planned_.from_rest = false;
    ++planned_.number;
  }
  // An axis that still moves comes to rest first.
  bool follow(const AxisCommand& command, std::int64_t tick, CommandResult& result) noexcept {
    if (!is_inside(command.target)) {
      result = CommandResult::outside;
      return true;
    }
    if (!streams_ && !comes_ && !stop(tick)) return false;
    next_m_ = command.target;
    interval_ = std::max<std::int64_t>(std::llround(command.interval_s / period_s_), 1);
    moving_ = held_ = jogs_ = false;
    if (streams_) stream_.go(next_m_, interval_);
    else comes_ = true;
    if (comes_ && tick > planner_.end_tick()) begin_stream(tick);
    return true;
  }
  void begin_stream(std::int64_t tick) noexcept {
    comes_ = false;
    if (next_m_ == planner_.target_m()) return;
    stream_.start(tick - 1, planner_.target_m());
    stream_.go(next_m_, interval_);
    plan_changed();
    streams_ = true;
  }
  void wanted(double target_m, double speed_mps) noexcept {
    wanted_m_ = target_m;
    wanted_mps_ = speed_mps;
    moving_ = true;
    held_ = false;
  }

  LivePlanner planner_;
  SetPointStream stream_;
  PlannedMove planned_;
  std::int64_t wait_ = 0;
  double period_s_ = 1e-3;
  bool proven_ = false, moving_ = false, held_ = false, jogs_ = false;
  bool streams_ = false, comes_ = false;  // a stream moves the axis; its first set point waits for rest
  double wanted_m_ = 0.0, wanted_mps_ = 0.0, next_m_ = 0.0;
  std::int64_t interval_ = 1;
};

}  // namespace pneuservo
