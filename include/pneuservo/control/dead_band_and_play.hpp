// What is added to a command for the known dead band or play of the valve: half of it.
#pragma once
#include <algorithm>

#include <pneuservo/elements/effects.hpp>

namespace pneuservo {

/// Adds to a command what was asked for once more, up to a dead band, or the way since its turn, up to half a play;
/// only for the larger of both, so that its slope is at most 2 (docs/physics/pd_force.md). HOT.
class DeadBandAndPlayCompensation {
 public:
  /// What the last command leaves behind.
  struct State {
    double asked_V = 0.0, play_V = 0.0;
  };

  DeadBandAndPlayCompensation() noexcept = default;
  /// The least overlap of the four edges counts: no edge opens further than the command alone says.
  explicit DeadBandAndPlayCompensation(const ValveEffects<double>& known) noexcept
      : half_band_V_(least_overlap_V(known)), offset_V_(known.valve_offset.offset_V),
        half_play_V_(0.5 * known.valve_hysteresis.width_V), acts_(half_band_V_ > 0.0 || half_play_V_ > 0.0) {
    if (half_band_V_ < half_play_V_) half_band_V_ = 0.0;
    else half_play_V_ = 0.0;
  }

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
  /// An underlap takes nothing and gets nothing.
  static double least_overlap_V(const ValveEffects<double>& known) noexcept {
    const auto& beside = known.valve_edge_overlaps;
    const double least = std::min({beside.supply_1, beside.exhaust_1, beside.supply_2, beside.exhaust_2, 0.0});
    return std::max(known.valve_dead_band.width_V * (1.0 + least), 0.0);
  }
  static double limited(double value_V, double most_V) noexcept { return std::clamp(value_V, -most_V, most_V); }
  double half_band_V_ = 0.0, offset_V_ = 0.0, half_play_V_ = 0.0;
  bool acts_ = false;
};

}  // namespace pneuservo
