// Judges one measured channel tick by tick: bridges a spike, latches nothing itself, tells missing, jumping and frozen.
#pragma once
#include <cmath>
#include <cstdint>

#include <pneuservo/hal/channel.hpp>

namespace pneuservo {

/// What a channel may do. Values in the channel's unit.
struct PlausibleChannel {
  double lowest = 0.0, highest = 0.0;  ///< outside: no measurement
  double largest_step = 0.0;  ///< from tick to tick; 0: any
  double frozen_step =
      0.0;  ///< a channel that last moved by more than this and then repeats itself is frozen; 0: not judged so
  bool noisy = false;  ///< the sensor's noise makes repetition impossible
};

/// Good samples pass. A bad one (missing, NaN, out of range, a jump) is replaced by the last good one for at most two
/// ticks; the third in a row is a fault. Twenty equal samples are a frozen channel where equality cannot be physics.
class InputGuard {
 public:
  static constexpr int bridged_ticks = 2;
  static constexpr int frozen_ticks = 20;

  void configure(const PlausibleChannel& plausible) noexcept {
    plausible_ = plausible;
    reset();
  }
  void reset() noexcept {
    bad_ = jumps_ = equal_ = 0;
    last_step_ = 0.0;
    started_ = false;
  }
  /// The value to use; `missing`, `jumped` and `frozen` say afterwards what is wrong for good.
  double check(const Channel& channel) noexcept {
    missing = jumped = frozen = false;
    const bool readable = channel.valid && channel.value >= plausible_.lowest && channel.value <= plausible_.highest;
    const double step = channel.value - value_;
    const bool jump =
        readable && started_ && plausible_.largest_step > 0.0 && std::fabs(step) > plausible_.largest_step * (bad_ + 1);
    if (!readable || jump) return bridge(jump);
    if (started_ && step == 0.0) {
      ++equal_;
    } else {
      equal_ = 0;
      last_step_ = started_ ? step : 0.0;  // the first sample is no motion
    }
    frozen = equal_ >= frozen_ticks &&
             (plausible_.noisy || (plausible_.frozen_step > 0.0 && std::fabs(last_step_) > plausible_.frozen_step));
    bad_ = jumps_ = 0;
    started_ = true;
    return value_ = channel.value;
  }

  bool missing = false, jumped = false, frozen = false;

 private:
  double bridge(bool jump) noexcept {
    ++bad_;
    jumps_ += jump ? 1 : 0;
    if (bad_ > bridged_ticks || !started_) {
      jumped = jump && jumps_ > bridged_ticks;
      missing = !jumped;
    }
    return value_;
  }
  PlausibleChannel plausible_;
  double value_ = 0.0, last_step_ = 0.0;
  int bad_ = 0, jumps_ = 0, equal_ = 0;
  bool started_ = false;
};

}  // namespace pneuservo
