// The config's axis with the piston led along the reference: what its chambers give under a command.
#pragma once
#include <vector>

#include <pneuservo/control/dead_band_and_play.hpp>
#include <pneuservo/control/pass_table.hpp>
#include <pneuservo/control/reference.hpp>
#include <pneuservo/rig/plant.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// The reference as a pass takes it: the whole, or slower (`speed` below 1) or smaller about its first position.
struct MotionScale {
  double speed = 1.0, size = 1.0;
};

/// A reference on the ticks of a pass: rest before its time 0, then the reference, then more of it (or of its rest)
/// than is used, so that what is learned there need not end well.
class PassMotion {
 public:
  /// `reference` must outlive it.
  PassMotion(const Rig& rig, const Reference& reference, const MotionScale& scale);
  ReferencePoint at(std::size_t tick) const noexcept;
  std::size_t first() const noexcept { return first_; }  ///< tick of the reference's time 0
  std::size_t used() const noexcept { return used_; }    ///< ticks of the run from there on
  std::size_t ticks() const noexcept { return first_ + used_ + after_; }

 private:
  const Reference& reference_;
  MotionScale scale_;
  double period_s_;
  std::size_t first_, used_, after_;
};

/// What was there at the begin of a tick, and the command of the period that follows: as asked for, and with what is
/// added for the valve's known dead band or play.
struct LedTick {
  double asked_V = 0.0, u_V = 0.0, force_N = 0.0, wanted_N = 0.0;
  PerSignal<double> values;  ///< as exact sensors would show them
};

/// The axis without what swallows a small pulse: dry friction, and dead band, play and stiction of the valve.
AxisParameters<double> smooth_axis(AxisParameters<double> axis);

/// Valve, lines, chambers, supply and all effects of the config; the slider goes where it is led. Cold.
class LedAxis {
 public:
  /// Dry friction changes its sign over this speed: faster than the chambers follow, slower than a jump.
  static constexpr double turning_mps = 4e-3;
  /// Cells of the lines: with 1 a metre the thinnest lines leave 0.3 mm, with 4 less than 0.05 mm.
  static constexpr double cells_per_m = 4.0;

  LedAxis(const Rig& rig, double force_feedback_V_per_N);
  /// Runs the motion with asked_V[tick], the feedback of the force and what the law adds for the valve; with an empty
  /// one, with the formula's.
  const std::vector<LedTick>& run(const PassMotion& motion, const std::vector<double>& asked_V);
  /// Of the last run.
  const std::vector<LedTick>& ticks() const noexcept { return ticks_; }
  /// Change of the force [N/V] in the ticks after a pulse of one period at rest, without dead band, play and offset.
  std::vector<double> pulse_response(double pulse_V, std::size_t ticks);

 private:
  double limited_V(double command_V) const noexcept;
  void start(AxisPlant<double>& plant, double position_m) const noexcept;

  const Rig& rig_;
  double feedback_V_per_N_;
  DeadBandAndPlayCompensation compensation_;
  AxisPlant<double> plant_;
  std::vector<LedTick> ticks_;
};

}  // namespace pneuservo
