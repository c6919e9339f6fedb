// What is added to a command for the known dead band or play of the valve: half of it.
#pragma once
#include <algorithm>

#include <pneuservo/elements/effects.hpp>

namespace pneuservo {

/// A dead band of half width w about -offset takes no command below w; this one adds the command's own size up to w, so
/// the valve opens from w/2 on and gives all of it from w on. A play of half width w takes 2 w where the command turns;
/// this one adds the way since the turn, from -w to w. Its slope is nowhere above 2, the gain margin that `design` asks
/// of every loop. A valve with a dead band rests in it, and its play then gets nothing. HOT.
class ValveInverse {
 public:
  /// What the last command leaves behind.
  struct State {
    double asked_V = 0.0, play_V = 0.0;
  };

  ValveInverse() noexcept = default;
  /// An underlap (a width below 0) takes nothing and gets nothing.
  explicit ValveInverse(const ValveEffects<double>& known) noexcept
      : half_band_V_(std::max(known.valve_dead_band.width_V, 0.0)), offset_V_(known.valve_offset.offset_V),
        half_play_V_(half_band_V_ > 0.0 ? 0.0 : 0.5 * known.valve_hysteresis.width_V),
        acts_(half_band_V_ > 0.0 || half_play_V_ > 0.0) {}

  State next(const State& before, double asked_V) const noexcept {
    return {asked_V, acts_ ? limited(before.play_V + asked_V - before.asked_V, half_play_V_) : 0.0};
  }
  double command_V(const State& now) const noexcept {
    return acts_ ? now.asked_V + limited(now.asked_V + offset_V_, half_band_V_) + now.play_V : now.asked_V;
  }
  /// In the middle of the play, with what was asked for where the command is this one.
  State at(double command_V) const noexcept {
    return {command_V - limited(0.5 * (command_V + offset_V_), half_band_V_), 0.0};
  }

 private:
  static double limited(double value_V, double most_V) noexcept { return std::clamp(value_V, -most_V, most_V); }
  double half_band_V_ = 0.0, offset_V_ = 0.0, half_play_V_ = 0.0;
  bool acts_ = false;
};

}  // namespace pneuservo
