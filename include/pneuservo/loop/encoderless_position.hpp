// The loop's position where there is no encoder: observer, switches, and what the law is shown.
#pragma once
#include <array>
#include <cstdint>

#include <pneuservo/elements/valve_inflow.hpp>
#include <pneuservo/estimator/pipeline_estimator.hpp>
#include <pneuservo/estimator/position_observer.hpp>
#include <pneuservo/hal/channel.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// What the observer must know, from the rig: its uncertainty from tolerances and the section `position`.
PositionObserverParameters position_observer_parameters(const Rig& rig);

/// Off where the rig has an encoder. Rests for settle_s after a start, while the estimator finds the gas's state.
class EncoderlessPosition {
 public:
  static constexpr double settle_s = 1.5;
  /// A correction reaches the law within about this, so that its velocity does not take it for a blow.
  static constexpr double blend_s = 0.05;
  /// So long after a passage the axis is still on its way from where it was believed to be.
  static constexpr double return_s = 0.3;

  /// Cold. Allocates the valves' delay lines.
  void configure(const Rig& rig);
  void reset() noexcept;
  bool is_on() const noexcept { return is_on_; }
  bool is_settled() const noexcept { return ticks_ >= settled_after_; }
  double position_m() const noexcept { return observer_.position_m(); }
  double velocity_mps() const noexcept { return observer_.velocity_mps(); }
  /// What the law is shown: a correction comes in slowly.
  double shown_m() const noexcept { return observer_.position_m() - withheld_m_; }
  double shift_m() const noexcept { return observer_.shift_m(); }
  double bound_m() const noexcept { return observer_.bound_m(); }
  /// What the position shown to the law may have been wrong by of late, and how fast a correction of it comes in.
  double doubt_m() const noexcept { return doubt_m_; }
  double doubt_mps() const noexcept { return doubt_m_ / blend_s; }
  const PositionObserver& observer() const noexcept { return observer_; }
  /// The bound is above what the config allows, a switch cannot be read, or slots passed unseen.
  bool is_lost() const noexcept { return lost_ || bound_m() > bound_max_m_; }
  /// After the estimator of this tick; `command_V` was in force over the period that ends now, `skipped` slots before.
  void step(const std::array<double, 2>& command_V, const std::array<double, 2>& port_Pa, double supply_Pa,
            const EstimatorOutput& estimate, std::int64_t skipped) noexcept;
  /// The switches of this tick, after step.
  void see(const DigitalInputs& digital) noexcept;

 private:
  void pass(const DigitalLine& line, LineState& last, double on_m, double off_m) noexcept;

  PositionParameters parameters_;
  PositionObserver observer_;
  ValveInflow valves_;
  LineState low_ = LineState::absent, high_ = LineState::absent;
  double bound_max_m_ = 0.0, withheld_m_ = 0.0, blend_ = 1.0, doubt_m_ = 0.0, return_ = 1.0;
  std::int64_t settled_after_ = 0, ticks_ = 0;
  bool is_on_ = false, lost_ = false;
};

}  // namespace pneuservo
