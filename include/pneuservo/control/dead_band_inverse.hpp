// What is added to a command for the known dead band of the valve: half of it.
#pragma once
#include <algorithm>

#include <pneuservo/elements/effects.hpp>

namespace pneuservo {

/// A dead band of half width w about -offset takes no command below w; this one adds the command's own size up to w, so
/// the valve opens from w/2 on and gives all of it from w on. Its slope is nowhere above 2, the gain margin that
/// `design` asks of every loop, and with the dead band behind it the valve never opens further than the command alone
/// says. HOT.
class DeadBandInverse {
 public:
  DeadBandInverse() noexcept = default;
  /// An underlap (a width below 0) takes nothing and gets nothing.
  explicit DeadBandInverse(const ValveEffects<double>& known) noexcept
      : half_width_V_(std::max(known.valve_dead_band.width_V, 0.0)), offset_V_(known.valve_offset.offset_V) {}

  double command_V(double asked_V) const noexcept { return asked_V + limited(asked_V + offset_V_); }
  /// What was asked for where the command is this one.
  double asked_V(double command_V) const noexcept { return command_V - limited(0.5 * (command_V + offset_V_)); }

 private:
  double limited(double value_V) const noexcept { return std::clamp(value_V, -half_width_V_, half_width_V_); }
  double half_width_V_ = 0.0, offset_V_ = 0.0;
};

}  // namespace pneuservo
