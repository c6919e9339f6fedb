// The pressures of both sides in one pass while all are calm; what is not calm is left to their guards.
#pragma once
#include <algorithm>
#include <array>

#include <pneuservo/core/pack.hpp>
#include <pneuservo/loop/input_guard.hpp>

namespace pneuservo {

/// Port and chamber pressures are calm while each tick brings each of them a plausible value and none is frozen. Then
/// one pass in lanes says what four guards would say. Pressures alone: their steps do not hang on the step before. HOT.
class CalmPressures {
 public:
  static constexpr std::array<Signal, 4> signals{Signal::p1_port, Signal::p2_port, Signal::p1_chamber,
                                                 Signal::p2_chamber};
  using Four = Pack<double, signals.size()>;

  /// `most_Pa`: a higher pressure is not calm, whatever the channel may show.
  void configure(const PerSignal<PlausibleChannel>& plausible, double most_Pa) noexcept {
    const auto of_each = [&](auto&& value) noexcept {
      return lanes([&](Signal signal) noexcept { return value(plausible[signal]); });
    };
    lowest_ = of_each([](const PlausibleChannel& p) noexcept { return p.lowest; });
    highest_ = of_each([&](const PlausibleChannel& p) noexcept { return std::min(p.highest, most_Pa); });
    largest_step_ = of_each([](const PlausibleChannel& p) noexcept { return p.slack + p.step_per_period; });
    oldest_s_ = of_each([](const PlausibleChannel& p) noexcept { return p.oldest_s; });
    frozen_ticks_ = of_each([](const PlausibleChannel& p) noexcept {
      return p.frozen_ticks > 0 ? p.frozen_ticks : std::numeric_limits<double>::infinity();
    });
    reset();
  }
  void reset() noexcept { is_calm_ = false; }
  /// After a tick that the guards judged, with `judged` those that are in use.
  void begin(const PerSignal<InputGuard>& guards, const PerSignal<bool>& judged) noexcept {
    is_calm_ =
        std::ranges::all_of(signals, [&](Signal signal) noexcept { return !judged[signal] || guards[signal].good(); });
    if (!is_calm_) return;
    value_ = lanes([&](Signal signal) noexcept { return guards[signal].value(); });
    equal_ticks_ = lanes([&](Signal signal) noexcept { return static_cast<double>(guards[signal].equal_ticks()); });
    unused_ = lanes([&](Signal signal) noexcept { return judged[signal] ? 0.0 : 1.0; }) > Four(0);
  }
  /// A tick that follows at once: true where all are calm still, then `values` are theirs (NaN: not in use).
  bool take(const PerSignal<Channel>& channels, const PerSignal<bool>& judged, Four& values) noexcept {
    if (!is_calm_) return false;
    bool there = true;
    for (const Signal signal : signals)
      there &= judged[signal] ? channels[signal].valid : channels[signal].origin == Origin::absent;
    const Four now = lanes([&](Signal signal) noexcept { return channels[signal].value; }),
               age_s = lanes([&](Signal signal) noexcept { return channels[signal].age_s; });
    const Four step = now - value_, equal_ticks = select(step == Four(0), equal_ticks_ + Four(1), Four(0));
    const auto plausible = (now >= lowest_) & (now <= highest_) & (absolute(step) <= largest_step_) &
                           (age_s <= oldest_s_) & (equal_ticks < frozen_ticks_);
    if (!there || !all(plausible | unused_)) return false;
    value_ = now;
    equal_ticks_ = equal_ticks;
    values = select(unused_, Four(std::numeric_limits<double>::quiet_NaN()), now);
    return true;
  }
  /// The guards go on where the calm ends.
  void leave(PerSignal<InputGuard>& guards) noexcept {
    if (!is_calm_) return;
    is_calm_ = false;
    for (std::size_t i = 0; i < signals.size(); ++i)
      if (const int lane = static_cast<int>(i); !unused_[lane])
        guards[signals[i]].go_on_from(value_[lane], static_cast<int>(equal_ticks_[lane]));
  }

 private:
  template <class F> static Four lanes(F&& of) noexcept {
    return join(join(of(signals[0]), of(signals[1])), join(of(signals[2]), of(signals[3])));
  }
  Four lowest_, highest_, largest_step_, oldest_s_, frozen_ticks_, value_, equal_ticks_;
  Mask<Four> unused_{};
  bool is_calm_ = false;
};

}  // namespace pneuservo
