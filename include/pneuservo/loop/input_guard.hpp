// Judges one measured channel tick by tick: bridges a spike, latches nothing itself, tells missing, jumping and frozen.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <pneuservo/core/rt.hpp>
#include <pneuservo/hal/channel.hpp>

namespace pneuservo {

/// What a channel may do. Values in the channel's unit.
struct PlausibleChannel {
  double lowest = 0.0, highest = 0.0;  ///< outside: no measurement
  double slack = 0.0;  ///< noise and quantum may make this much of a step
  double step_per_period = std::numeric_limits<double>::infinity();  ///< what physics adds in a control period
  /// By so much a step may exceed the one before, a period later (a mass can only be accelerated so fast).
  double step_growth = std::numeric_limits<double>::infinity();
  /// A channel whose last change was larger than this (per period) and that then repeats itself is frozen.
  double stopping_step = std::numeric_limits<double>::infinity();
  int frozen_ticks = 0;  ///< equal samples in a row that the sensor's noise rules out; 0: equality proves nothing
  int start_ticks = 100;  ///< a channel without any value yet is waited for so long
  int missing_ticks = 2;  ///< samples in a row that may be missing; a jump may be a spike and is always given two
  double oldest_s = std::numeric_limits<double>::infinity();  ///< an older sample is none; grows with skipped periods
  double period_s = 0.0;
};

/// What a guard says of the sample of a tick.
enum class InputFinding : std::uint8_t {
  none,
  bridged,  ///< bad, and replaced by the last good one
  missing,  ///< bad for good: invalid, too old, not a number, impossible
  jumped,  ///< bad for good: further than physics goes
  frozen,  ///< the channel repeats one value
};

/// Good samples pass. A bad one is replaced by the last good one in the tick in which it comes and counted: of missing
/// ones (invalid, too old, NaN, out of range) missing_ticks in a row are bridged, of jumps two, because the first
/// sample of a jump cannot be told from a spike; one more is a fault. A run of equal samples is a frozen channel only
/// where neither rest nor a coarse quantum can explain it.
class InputGuard {
 public:
  static constexpr int bridged_ticks = 2;
  static constexpr int stopped_ticks = 20;

  void configure(const PlausibleChannel& plausible) noexcept {
    plausible_ = plausible;
    reset();
  }
  void reset() noexcept {
    bad_ = jumps_ = equal_ = 0;
    missed_ = last_step_ = 0.0;
    value_ = std::numeric_limits<double>::quiet_NaN();
    started_ = false;
    finding_ = InputFinding::none;
  }
  /// The value to use (NaN while waiting for the first); `finding` says afterwards what was wrong with the sample.
  /// `periods` since the last call; `extra_step()`: what else this tick's step may hold, asked only where the step is
  /// too large without; `may_stop`: something solid is in the way, so that standing still at once is no wonder.
  template <class Extra>
  double check(const Channel& channel, double periods, Extra&& extra_step,
               bool may_stop = false) noexcept PNEUSERVO_NONBLOCKING {
    finding_ = InputFinding::none;
    const double elapsed = missed_ + periods;  // since the last good sample
    const bool fresh = channel.valid && channel.age_s <= plausible_.oldest_s + (periods - 1.0) * plausible_.period_s;
    const bool readable = fresh && channel.value >= plausible_.lowest && channel.value <= plausible_.highest;
    const double step = channel.value - value_;
    const double a_period =
        std::min(plausible_.step_per_period, std::fabs(last_step_) + plausible_.step_growth * elapsed);
    const double largest = plausible_.slack + a_period * elapsed;
    const bool jump = readable && started_ && std::fabs(step) > largest && std::fabs(step) > largest + extra_step();
    if (!readable || jump) [[unlikely]] {
      missed_ = elapsed;
      return bridge(jump);
    }
    if (started_ && step == 0.0) {
      repeat(may_stop);
    } else {
      equal_ = 0;
      last_step_ = !started_ ? 0.0 : elapsed == 1.0 ? step : step / elapsed;
    }
    bad_ = jumps_ = 0;
    missed_ = 0.0;
    started_ = true;
    return value_ = channel.value;
  }
  double check(const Channel& channel, double periods = 1.0) noexcept PNEUSERVO_NONBLOCKING {
    return check(channel, periods, [] { return 0.0; });
  }
  InputFinding finding() const noexcept { return finding_; }
  /// The sample was there and plausible, and the channel lives.
  bool good() const noexcept { return started_ && finding_ == InputFinding::none; }
  /// This tick's sample was not the one to use, whatever came of it.
  bool bad() const noexcept { return started_ && bad_ > 0; }
  /// No good sample has come yet.
  bool waiting() const noexcept { return !started_; }
  /// The last good value; NaN before the first.
  double value() const noexcept { return value_; }
  /// Somebody else judged good samples up to this value. Of a channel whose steps do not hang on the one before.
  void go_on_from(double value, int equal_ticks) noexcept {
    value_ = value;
    equal_ = equal_ticks;
  }
  /// Samples in a row that repeat the one before.
  int equal_ticks() const noexcept { return equal_; }

 private:
  void repeat(bool may_stop) noexcept {
    ++equal_;
    const bool noise_denies = plausible_.frozen_ticks > 0 && equal_ >= plausible_.frozen_ticks;
    const bool stopped = equal_ >= stopped_ticks && !may_stop && std::fabs(last_step_) > plausible_.stopping_step;
    if (noise_denies || stopped) finding_ = InputFinding::frozen;
    if (may_stop) last_step_ = 0.0;
  }
  double bridge(bool jump) noexcept {
    bad_ = std::min(bad_ + 1, std::numeric_limits<int>::max() - 1);
    jumps_ += jump ? 1 : 0;
    if (!started_) {
      if (bad_ > plausible_.start_ticks) finding_ = InputFinding::missing;
    } else if (bad_ - jumps_ > plausible_.missing_ticks || bad_ > bridged_ticks) {
      finding_ = jump && jumps_ > bridged_ticks ? InputFinding::jumped : InputFinding::missing;
    } else {
      finding_ = InputFinding::bridged;
    }
    return value_;
  }
  PlausibleChannel plausible_;
  double value_ = std::numeric_limits<double>::quiet_NaN(), last_step_ = 0.0, missed_ = 0.0;
  int bad_ = 0, jumps_ = 0, equal_ = 0;
  bool started_ = false;
  InputFinding finding_ = InputFinding::none;
};

}  // namespace pneuservo
