// Set points at run time: moves that are planned anew from any state of motion, without leaving their limits.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/control/smoothstep.hpp>

namespace pneuservo {

/// What moves may ask for; in Pa in place of m where a pressure is commanded.
struct LiveLimits {
  double lowest_m = 0.0, highest_m = 0.0;
  double speed_mps = 0.1, acceleration_mps2 = 1.0;
  int smoothness = 11;  ///< degree of the smoothstep of a change of speed: 2 k + 1 for k + 1 continuous derivatives
  double unit_m = 0x1p-40;  ///< set points of a stream are whole multiples of it
};

/// Those of a reference of kind `live`.
inline LiveLimits live_limits(const ReferenceSpec& live) noexcept {
  return {live.lowest_m, live.highest_m, live.speed_mps, live.acceleration_mps2, live.smoothness};
}

/// A line that runs to the target at constant speed, smoothed by a kernel of finite length
/// (docs/physics/references.md).
///
/// The line's speed is constant but for jumps on ticks; the set point is its convolution with the derivative of a
/// smoothstep of transition() ticks. So it stays within what the line has been over that time: position between start
/// and targets, speed within the line's. A line that turns rests for transition() ticks in between, so that the kernel
/// never sees both directions and the acceleration stays below its limit. All that a plan holds lies in the jumps: the
/// set point is known for every future tick. All of it but configure is HOT.
class LivePlanner {
 public:
  /// Jumps within one transition. Plans beyond wait for the oldest to pass.
  static constexpr std::size_t most_jumps = 64;

  void configure(const LiveLimits& limits, double period_s) noexcept {
    limits_ = limits;
    period_s_ = period_s;
    const auto s = smoothstep_coefficients(limits.smoothness);
    const std::size_t flatness = static_cast<std::size_t>(limits.smoothness - 1) / 2;
    transition_ = transition_ticks(limits, period_s);
    transition_s_ = static_cast<double>(transition_) * period_s;
    per_transition_ = 1.0 / static_cast<double>(transition_);
    // Terms of the smoothstep's integral and its derivatives; their lowest powers of z stand apart.
    const std::size_t lowest = flatness + 2;
    for (auto& term : coefficients_) term.fill(0.0);
    for (std::size_t order = 0; order < orders; ++order) {
      power_[order] = order > lowest ? 0 : lowest - order;
      scale_[order] = std::pow(transition_s_, 1.0 - static_cast<double>(order));
      mirrored_[order] = order % 2 == 1 ? -scale_[order] : scale_[order];
      for (std::size_t term = order > lowest ? order - lowest : 0; term <= flatness; ++term) {
        double c = s[flatness + 1 + term] / static_cast<double>(lowest + term);
        for (std::size_t i = 0; i < order; ++i) c *= static_cast<double>(lowest + term - i);
        coefficients_[lowest + term - order - power_[order]][order] = c;
      }
    }
    start(0, 0.0);
  }

  /// Ticks that a change of speed takes, so that the largest speed is gained within the acceleration.
  static std::int64_t transition_ticks(const LiveLimits& limits, double period_s) noexcept {
    return std::max<std::int64_t>(std::llround(std::ceil(transition_s(limits) / period_s)), 1);
  }
  /// Peak slope of the smoothstep times speed over acceleration.
  static double transition_s(const LiveLimits& limits) noexcept {
    const auto s = smoothstep_coefficients(limits.smoothness);
    double slope = 0.0;
    for (std::size_t i = s.size() - 1; i > 0; --i) slope = 0.5 * slope + static_cast<double>(i) * s[i];
    return slope * limits.speed_mps / limits.acceleration_mps2;
  }

  /// Rests there from that tick on.
  void start(std::int64_t tick, double position_m) noexcept {
    base_ = {tick, position_m, 0.0, 0.0};
    first_ = count_ = 0;
    target_m_ = position_m;
  }

  /// From `tick` on to the target (held to the range) at the speed (held to the limit). False: no room, nothing
  /// changed.
  bool move_to(std::int64_t tick, double target_m, double speed_mps) noexcept {
    pass(tick);
    if (!has_room(tick, jumps_of_move + 1)) return false;  // one is left for a stop
    const double at_m = cut(tick), target = std::clamp(target_m, limits_.lowest_m, limits_.highest_m);
    const double way_m = target - at_m, before_mps = last().to_mps;
    target_m_ = target;
    if (way_m == 0.0) {
      jump(tick, at_m, 0.0);
      return true;
    }
    if (before_mps * way_m < 0.0) jump(tick, at_m, 0.0);
    const std::int64_t begin = std::max(tick, turned_until(way_m));
    const double periods = std::max(std::ceil(std::fabs(way_m) / (held_speed(speed_mps) * period_s_)), 1.0);
    jump(begin, at_m, way_m / (periods * period_s_));
    jump(begin + std::llround(periods), target, 0.0);
    return true;
  }
  /// On to the end of the range in the direction of the speed.
  bool jog(std::int64_t tick, double speed_mps) noexcept {
    const double end_m = speed_mps > 0.0 ? limits_.highest_m : limits_.lowest_m;
    if (speed_mps * (end_m - line_m(tick)) <= 0.0) return stop(tick);
    return move_to(tick, end_m, std::fabs(speed_mps));
  }
  /// Comes to rest within one transition, half of it at the speed away from the present set point.
  bool stop(std::int64_t tick) noexcept {
    pass(tick);
    if (!has_room(tick, 1)) return false;
    const double at_m = cut(tick);
    jump(tick, at_m, 0.0);
    target_m_ = at_m;
    return true;
  }

  /// Set point with its derivatives at tick + ahead, ahead >= 0 in periods; not before the last pass().
  ReferencePoint at(std::int64_t tick, double ahead = 0.0) const noexcept {
    ReferencePoint point;
    const Jump* line = &base_;
    point.d[0] = -0.5 * transition_s_ * base_.to_mps;
    point.d[1] = base_.to_mps;
    for (std::size_t i = 0; i < count_; ++i) {
      const Jump& jump = jump_at(i);
      const double since = static_cast<double>(tick - jump.tick) + ahead;
      if (since <= 0.0) break;
      line = &jump;
      add(jump.to_mps - jump.from_mps, since, point);
    }
    point.d[0] += line->position_m + line->to_mps * ((static_cast<double>(tick - line->tick) + ahead) * period_s_);
    return point;
  }
  /// Forgets jumps that no longer show; once a tick.
  void pass(std::int64_t tick) noexcept {
    while (count_ > 0 && jump_at(0).tick + transition_ <= tick) {
      base_ = jump_at(0);
      first_ = (first_ + 1) % most_jumps;
      --count_;
    }
  }

  /// Whether the set point rests in the tick, and since the last pass().
  bool rests(std::int64_t tick) const noexcept {
    return base_.to_mps == 0.0 && (count_ == 0 || jump_at(0).tick >= tick);
  }
  /// Tick from which on the set point rests.
  std::int64_t end_tick() const noexcept { return last().tick + transition_; }
  double target_m() const noexcept { return target_m_; }
  std::int64_t transition() const noexcept { return transition_; }
  const LiveLimits& limits() const noexcept { return limits_; }
  double period_s() const noexcept { return period_s_; }
  /// Jumps that a set point of now or later is made of.
  std::size_t jumps() const noexcept { return count_; }

 private:
  /// The line from `tick` on: where it is then, and its speed before and after.
  struct Jump {
    std::int64_t tick = 0;
    double position_m = 0.0, from_mps = 0.0, to_mps = 0.0;
  };
  static constexpr std::size_t jumps_of_move = 3;
  static constexpr std::size_t orders = std::tuple_size_v<decltype(ReferencePoint::d)>;
  static constexpr std::size_t most_terms = (smoothstep_degree_max + 1) / 2;

  const Jump& jump_at(std::size_t i) const noexcept { return jumps_[(first_ + i) % most_jumps]; }
  const Jump& last() const noexcept { return count_ > 0 ? jump_at(count_ - 1) : base_; }
  double held_speed(double speed_mps) const noexcept {
    const double slowest_mps = 1e-6 * limits_.speed_mps;  // a move must end
    return std::clamp(std::fabs(speed_mps), slowest_mps, limits_.speed_mps);
  }
  bool has_room(std::int64_t tick, std::size_t needed) const noexcept {
    std::size_t kept = 0;
    while (kept < count_ && jump_at(kept).tick < tick) ++kept;
    return kept + needed <= most_jumps;
  }
  double line_m(std::int64_t tick) const noexcept {
    const Jump* line = &base_;
    for (std::size_t i = 0; i < count_ && jump_at(i).tick <= tick; ++i) line = &jump_at(i);
    return line->position_m + line->to_mps * (static_cast<double>(tick - line->tick) * period_s_);
  }
  /// Takes back what was planned from there on; returns where the line is.
  double cut(std::int64_t tick) noexcept {
    const double at_m = line_m(tick);
    while (count_ > 0 && last().tick >= tick) --count_;
    return at_m;
  }
  void jump(std::int64_t tick, double position_m, double to_mps) noexcept {
    const double from_mps = last().to_mps;
    if (to_mps == from_mps) return;
    jumps_[(first_ + count_) % most_jumps] = {tick, position_m, from_mps, to_mps};
    ++count_;
  }
  /// Tick before which a line in the direction of way_m may not begin: the other direction has not passed yet.
  std::int64_t turned_until(double way_m) const noexcept {
    for (std::size_t i = count_; i-- > 0;)
      if (jump_at(i).from_mps * way_m < 0.0) return jump_at(i).tick + transition_;
    return base_.tick;
  }
  // Of the line's lag, T (z - I(z)) a speed, and of the derivatives; I the integral of the smoothstep. Near the end
  // from there, so that it arrives exactly: I(z) = z - 1/2 + I(1 - z).
  void add(double change_mps, double since, ReferencePoint& point) const noexcept {
    const double z = since * per_transition_;
    if (z >= 1.0) {
      point.d[0] -= 0.5 * transition_s_ * change_mps;
      point.d[1] += change_mps;
      return;
    }
    const bool late = z > 0.5;
    const double w = late ? 1.0 - z : z;
    std::array<double, smoothstep_degree_max> power{1.0};
    for (std::size_t i = 1; i < power.size(); ++i) power[i] = power[i - 1] * w;
    std::array<double, orders> value{};
    for (std::size_t term = most_terms; term-- > 0;)
      for (std::size_t order = 0; order < orders; ++order) value[order] = value[order] * w + coefficients_[term][order];
    for (std::size_t order = 0; order < orders; ++order) value[order] *= power[power_[order]];
    point.d[0] += change_mps * transition_s_ * (late ? value[0] - 0.5 : value[0] - z);
    point.d[1] += change_mps * (late ? 1.0 - value[1] : value[1]);
    const auto& scale = late ? mirrored_ : scale_;
    for (std::size_t order = 2; order < orders; ++order) point.d[order] += change_mps * scale[order] * value[order];
  }

  LiveLimits limits_;
  double period_s_ = 1e-3, transition_s_ = 1e-3, per_transition_ = 1.0, target_m_ = 0.0;
  std::int64_t transition_ = 1;
  std::size_t first_ = 0, count_ = 0;
  std::array<std::array<double, orders>, most_terms> coefficients_{};
  std::array<std::size_t, orders> power_{};
  std::array<double, orders> scale_{}, mirrored_{};
  Jump base_;
  std::array<Jump, most_jumps> jumps_{};
};

}  // namespace pneuservo
