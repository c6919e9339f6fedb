// A stream of set points from outside made into a motion: smooth, within limits, at rest when the stream ends.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include <pneuservo/control/live_planner.hpp>
#include <pneuservo/control/reference.hpp>

namespace pneuservo {

/// A line through the set points, seen through a cascade of moving averages (docs/physics/references.md).
///
/// Each of the k + 1 averages over L ticks makes one more derivative continuous, and its derivative is exact:
/// (x(t) - x(t - T))/T. Positions are whole multiples of a power of two, so that sums neither round nor drift and a
/// line at rest gives a set point at rest. The line's speeds differ by no more than the limit over the cascade's
/// length: the acceleration is then at most limit times the peak of the cascade's kernel. Only configure allocates; all
/// else is HOT and takes the same time in every tick.
class SetPointStream {
 public:
  /// `lead_s`: how far ahead of the set point the law looks; the stream is delayed by it.
  void configure(const LiveLimits& limits, double period_s, double lead_s) {
    limits_ = limits;
    period_s_ = period_s;
    stages_ = static_cast<std::size_t>(limits.smoothness + 1) / 2;
    length_ =
        static_cast<std::int64_t>(std::ceil(peak(stages_) * limits.speed_mps / (limits.acceleration_mps2 * period_s))) +
        1;
    lead_ = static_cast<std::int64_t>(std::ceil(lead_s / period_s));
    behind_s_ = static_cast<double>(lead_) * period_s - lead_s;
    std::size_t values = 0;
    for (std::size_t stage = 0; stage <= stages_; ++stage) {
      history_[stage] = {values, static_cast<std::size_t>(static_cast<std::int64_t>(stages_ - stage) * length_ + 2), 0};
      values += history_[stage].size;
    }
    values_.assign(values, 0);
    points_.assign(static_cast<std::size_t>(lead_) + 1, {});
    block_ticks_ = (cascade() + most_blocks - 2) / (most_blocks - 1);
    fastest_ = units(limits.speed_mps * period_s);
    start(0, 0.0);
  }
  /// Highest value of n boxes of length 1 folded with each other.
  static double peak(std::size_t n) noexcept {
    double sum = 0.0, binomial = 1.0, factorial = 1.0;
    for (std::size_t i = 1; i < n; ++i) factorial *= static_cast<double>(i);
    for (std::size_t i = 0; 2 * i < n; ++i) {
      const double power =
          std::pow(0.5 * static_cast<double>(n) - static_cast<double>(i), static_cast<double>(n) - 1.0);
      sum += (i % 2 == 0 ? binomial : -binomial) * power;
      binomial *= static_cast<double>(n - i) / static_cast<double>(i + 1);
    }
    return sum / factorial;
  }

  /// Rests there until that tick.
  void start(std::int64_t tick, double position_m) noexcept {
    tick_ = tick;
    line_ = target_ = base_ = units(position_m);
    left_ = since_ = 0;
    rested_ = rest_ticks();
    late_ = false;
    for (std::size_t stage = 0; stage <= stages_; ++stage) sum_[stage] = length_ * base_;
    block_.fill({});
    begun_block_ = 0;
    block_at_ = 0;
    newest_ = 0;
    points_[0] = {};
    points_[0].d[0] = metres(base_);
  }
  /// The line is to be there in so many ticks.
  void go(double target_m, std::int64_t ticks) noexcept {
    target_ = units(std::clamp(target_m, limits_.lowest_m, limits_.highest_m));
    left_ = std::max<std::int64_t>(ticks, 1);
  }
  void go_at(double target_m, double speed_mps) noexcept {
    const double way_m = std::fabs(target_m - metres(line_));
    const double speed = std::max(std::fabs(speed_mps), 1e-6 * limits_.speed_mps);
    go(target_m, std::llround(std::ceil(way_m / (speed * period_s_))));
  }
  /// The line stays where it is; the set point comes to rest there.
  void halt() noexcept { target_ = line_; }

  /// Up to that tick; `most_mps` holds the line's speed.
  void advance(std::int64_t tick, double most_mps) noexcept {
    const std::int64_t cap = std::min(fastest_, units(most_mps * period_s_));
    const std::int64_t steps = std::min(tick - tick_, most_steps);
    for (std::int64_t i = 0; i < steps; ++i) step(cap);
    tick_ = tick;
  }
  ReferencePoint now() const noexcept { return point(lead_); }
  /// Where the set point will be after the law's lead.
  ReferencePoint ahead() const noexcept {
    ReferencePoint moved = point(0);
    for (std::size_t order = 0; order < orders; ++order) {
      double value = 0.0;
      for (std::size_t i = orders; i-- > order;)
        value = moved.d[i] - value * behind_s_ / static_cast<double>(i - order + 1);
      moved.d[order] = value;
    }
    return moved;
  }

  bool rests() const noexcept { return rested_ >= rest_ticks(); }
  /// The line could not be at the set point in time.
  bool is_late() const noexcept { return late_; }
  double target_m() const noexcept { return metres(target_); }
  /// Tick from which on the set point rests if nothing more comes.
  std::int64_t end_tick() const noexcept {
    if (line_ == target_) return tick_ + rest_ticks() - std::min(rested_, rest_ticks());
    const std::int64_t way = target_ > line_ ? target_ - line_ : line_ - target_;
    return tick_ + std::max(left_, way / std::max<std::int64_t>(fastest_, 1) + 1) + rest_ticks();
  }
  /// Ticks that the cascade sees.
  std::int64_t cascade() const noexcept { return static_cast<std::int64_t>(stages_) * length_; }
  /// How long after the line the set point is where the line was.
  double delay_s() const noexcept {
    return (0.5 * static_cast<double>(cascade()) + static_cast<double>(lead_)) * period_s_;
  }

 private:
  static constexpr std::size_t most_stages = (smoothstep_degree_max + 1) / 2;
  static constexpr std::size_t orders = std::tuple_size_v<decltype(ReferencePoint::d)>;
  static_assert(most_stages + 1 < orders);
  static constexpr std::int64_t most_blocks = 17;
  static constexpr std::int64_t most_steps = 100;  // of skipped ticks; a late tick must not grow long itself

  struct History {
    std::size_t first = 0, size = 1, newest = 0;
  };
  struct Speeds {
    std::int64_t lowest = 0, highest = 0;
  };

  std::int64_t units(double position_m) const noexcept { return std::llround(position_m / limits_.unit_m); }
  double metres(std::int64_t units) const noexcept { return static_cast<double>(units) * limits_.unit_m; }
  std::int64_t rest_ticks() const noexcept { return cascade() + lead_ + 2; }

  /// What the stage gave so many ticks ago; before the start it gave what it began with.
  std::int64_t past(std::size_t stage, std::int64_t ago) const noexcept {
    if (ago >= since_) return base_;
    const History& h = history_[stage];
    const auto back = static_cast<std::size_t>(ago);
    return values_[h.first + (h.newest >= back ? h.newest - back : h.newest + h.size - back)];
  }
  void keep(std::size_t stage, std::int64_t value) noexcept {
    History& h = history_[stage];
    h.newest = h.newest + 1 == h.size ? 0 : h.newest + 1;
    values_[h.first + h.newest] = value;
  }
  const ReferencePoint& point(std::int64_t ago) const noexcept {
    const std::int64_t back = std::min(ago, since_), size = static_cast<std::int64_t>(points_.size());
    return points_[static_cast<std::size_t>((newest_ - back + size) % size)];
  }

  void step(std::int64_t cap) noexcept {
    const std::int64_t from = line_;
    move_line(cap);
    rested_ = line_ == from && line_ == target_ ? rested_ + 1 : 0;
    since_ = std::min(since_ + 1, rest_ticks());
    keep(0, line_);
    for (std::size_t stage = 1; stage <= stages_; ++stage) {
      const std::int64_t in = past(stage - 1, 0), out = past(stage - 1, length_);
      std::int64_t& sum = sum_[stage];
      sum += in - out;
      keep(stage, rounded(2 * sum - in + out, 2 * length_));
    }
    newest_ = (newest_ + 1) % static_cast<std::int64_t>(points_.size());
    points_[static_cast<std::size_t>(newest_)] = newest_point();
  }
  static std::int64_t rounded(std::int64_t value, std::int64_t by) noexcept {
    return value >= 0 ? (value + by / 2) / by : -((by / 2 - value) / by);
  }
  /// One tick towards the target, held to the speeds that those of the last cascade() ticks allow.
  void move_line(std::int64_t cap) noexcept {
    Speeds seen = block_[0];
    for (const Speeds& block : block_) {
      seen.lowest = std::min(seen.lowest, block.lowest);
      seen.highest = std::max(seen.highest, block.highest);
    }
    const std::int64_t wanted = (target_ - line_) / std::max<std::int64_t>(left_, 1);
    const std::int64_t speed = std::clamp(wanted, std::min(std::max(seen.highest - fastest_, -cap), std::int64_t{0}),
                                          std::max(std::min(seen.lowest + fastest_, cap), std::int64_t{0}));
    line_ += speed;
    left_ = std::max<std::int64_t>(left_ - 1, 0);
    if (left_ == 0) late_ = line_ != target_;
    if (++begun_block_ > block_ticks_) {
      begun_block_ = 1;
      block_at_ = block_at_ + 1 == block_.size() ? 0 : block_at_ + 1;
      block_[block_at_] = {speed, speed};
    }
    Speeds& block = block_[block_at_];
    block.lowest = std::min(block.lowest, speed);
    block.highest = std::max(block.highest, speed);
  }
  /// Derivative m is the m-th difference over L ticks of what all but m of the averages give.
  ReferencePoint newest_point() const noexcept {
    ReferencePoint point;
    const double per_length = 1.0 / (static_cast<double>(length_) * period_s_);
    double scale = limits_.unit_m;
    for (std::size_t order = 0; order <= stages_; ++order, scale *= per_length)
      point.d[order] = scale * static_cast<double>(difference(stages_ - order, order, 0));
    point.d[stages_ + 1] =
        scale / (per_length * period_s_) * static_cast<double>(difference(0, stages_, 0) - difference(0, stages_, 1));
    return point;
  }
  std::int64_t difference(std::size_t stage, std::size_t order, std::int64_t ago) const noexcept {
    std::int64_t sum = 0, binomial = 1;
    for (std::size_t i = 0; i <= order; ++i) {
      const std::int64_t value = binomial * past(stage, static_cast<std::int64_t>(i) * length_ + ago);
      sum += i % 2 == 0 ? value : -value;
      binomial = binomial * static_cast<std::int64_t>(order - i) / static_cast<std::int64_t>(i + 1);
    }
    return sum;
  }

  LiveLimits limits_;
  double period_s_ = 1e-3, behind_s_ = 0.0;
  std::size_t stages_ = most_stages;
  std::int64_t length_ = 1, lead_ = 0, block_ticks_ = 1, fastest_ = 0;
  std::array<History, most_stages + 1> history_{};
  std::array<std::int64_t, most_stages + 1> sum_{};
  std::vector<std::int64_t> values_;
  std::vector<ReferencePoint> points_;
  std::int64_t newest_ = 0;
  std::array<Speeds, static_cast<std::size_t>(most_blocks)> block_{};
  std::int64_t begun_block_ = 0;
  std::size_t block_at_ = 0;
  std::int64_t tick_ = 0, line_ = 0, target_ = 0, base_ = 0, left_ = 0, since_ = 0, rested_ = 0;
  bool late_ = false;
};

}  // namespace pneuservo
