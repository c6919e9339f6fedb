// Supervision of the motion itself: deviation from the prediction, speed, force on a slider that stands, contact with
// an end stop, and a start that cannot run away.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <pneuservo/loop/fault.hpp>

namespace pneuservo {

/// Limits of the motion of one axis; from the config, or derived by derive_motion_limits (src/loop/motion_limits.hpp).
struct MotionLimits {
  static constexpr double unlimited = std::numeric_limits<double>::infinity();
  double speed_mps = 5.0;
  double deviation_m = unlimited;          ///< between measured and predicted position
  double speed_deviation_mps = unlimited;  ///< between their speeds; finds an obstacle at once
  double stall_force_N = unlimited;      ///< force of the air on a slider that stands
  double start_command_V = unlimited;    ///< largest command until the start is proven
  double start_deviation_m = unlimited;  ///< in place of deviation_m until then
  double start_speed_mps = unlimited;    ///< in place of speed_mps until then
  double standing_m = 2e-4;              ///< less way than this is standing: noise and jitter of the encoder
  double half_stroke_m = unlimited;
  bool end_stop_is_fault = false;
};

/// One tick of a moving axis.
struct MotionSample {
  double position_m = 0.0, predicted_m = 0.0;
  double reference_m = 0.0;
  double speed_mps = 0.0;  ///< as the law filtered it
  double predicted_mps = 0.0;
  double force_N = 0.0;    ///< of both chambers on the piston
  double periods = 1.0;    ///< since the last sample
  double doubt_m = 0.0, doubt_mps = 0.0;  ///< what position and speed may be wrong by, where no encoder shows them
};

/// Judges every tick in which the axis is active; all of it but configure is HOT.
///
/// The start is proven when the prediction has gone start_way_over_deviation times start_deviation_m and the axis went
/// along: a reversed or exchanged valve, encoder, hose or sensor is twice as far off by then.
class MotionSupervision {
 public:
  static constexpr double start_way_over_deviation = 2.0;
  static constexpr double differs_s =
      0.005;  ///< a repeated or replaced sample or two and the step that follows are over
  static constexpr double stall_s = 0.25;         ///< longer than a reversal between motion both ways takes
  static constexpr double end_stop_apart_m = 1e-3;  ///< so far away the slider counts as having left the stop

  void configure(const MotionLimits& limits, double period_s) noexcept {
    limits_ = limits;
    period_s_ = period_s;
    reset();
  }
  /// After every re-arm.
  void reset() noexcept {
    proven_ = !std::isfinite(limits_.start_deviation_m);
    begins_ = true;
    was_off_stop_ = false;
    deviation_m_ = differs_s_ = 0.0;
  }
  std::uint64_t check(const MotionSample& now) noexcept {
    if (begins_) first(now);
    const double left_m = limits_.half_stroke_m - std::fabs(now.position_m);
    held_at_stop_ = left_m < end_stop_apart_m && now.force_N * now.position_m > 0.0;
    std::uint64_t faults = 0;
    deviation_m_ = now.position_m - now.predicted_m;
    const double off = std::fabs(deviation_m_), speed = std::fabs(now.speed_mps);
    if (!proven_) {
      if (off > limits_.start_deviation_m + now.doubt_m || speed > limits_.start_speed_mps + now.doubt_mps)
        faults |= fault_start_motion;
      proven_ = std::fabs(now.predicted_m - start_m_) > start_way_over_deviation * limits_.start_deviation_m;
    }
    // Until the start is proven it is the start that went wrong.
    const bool leaves = off > limits_.deviation_m + now.doubt_m || differs_in_speed(now);
    if (leaves) faults |= proven_ ? fault_deviation : fault_start_motion;
    if (speed > limits_.speed_mps + now.doubt_mps) faults |= fault_speed;
    return faults | end_stop(now) | stall(now);
  }
  /// Largest command that the law may give now. A slider that the air holds at an end stop is freed at full flow.
  double most_command_V() const noexcept {
    return proven_ || held_at_stop_ ? MotionLimits::unlimited : limits_.start_command_V;
  }
  bool proven() const noexcept { return proven_; }
  /// Measured less predicted position of the last tick.
  double deviation_m() const noexcept { return deviation_m_; }
  const MotionLimits& limits() const noexcept { return limits_; }

 private:
  void first(const MotionSample& now) noexcept {
    begins_ = false;
    start_m_ = now.predicted_m;
    stood_at_m_ = now.position_m;
    stands_s_ = 0.0;
  }
  // The same way for longer than the samples that the guards bridge.
  bool differs_in_speed(const MotionSample& now) noexcept {
    const double faster = now.speed_mps - now.predicted_mps;
    const bool goes_on = (faster > 0.0) == was_faster_ && differs_s_ > 0.0;
    was_faster_ = faster > 0.0;
    if (std::fabs(faster) <= limits_.speed_deviation_mps + now.doubt_mps) differs_s_ = 0.0;
    else differs_s_ = (goes_on ? differs_s_ : 0.0) + period_s_;
    return differs_s_ > std::max(differs_s, 2.5 * period_s_);
  }
  std::uint64_t end_stop(const MotionSample& now) noexcept {
    const double left = limits_.half_stroke_m - std::fabs(now.position_m);
    const bool contact = was_off_stop_ && left < limits_.standing_m;
    was_off_stop_ = contact ? false : was_off_stop_ || left > end_stop_apart_m;
    // A reference that ends at the stop asks for the contact.
    const bool asked = limits_.half_stroke_m - std::fabs(now.reference_m) < end_stop_apart_m;
    return contact && !asked && limits_.end_stop_is_fault ? std::uint64_t{fault_end_stop} : 0;
  }
  // At an end stop where the prediction stands too, the stop carries the force.
  std::uint64_t stall(const MotionSample& now) noexcept {
    const bool moves = std::fabs(now.position_m - stood_at_m_) > limits_.standing_m;
    const bool rests = limits_.half_stroke_m - std::fabs(now.predicted_m) < end_stop_apart_m;
    if (moves || rests || std::fabs(now.force_N) <= limits_.stall_force_N) {
      stood_at_m_ = now.position_m;
      stands_s_ = 0.0;
      return 0;
    }
    stands_s_ += now.periods * period_s_;
    return stands_s_ > stall_s ? std::uint64_t{fault_stall} : 0;
  }

  MotionLimits limits_;
  double period_s_ = 1e-3;
  bool proven_ = true, begins_ = true, was_off_stop_ = false, was_faster_ = false, held_at_stop_ = false;
  double start_m_ = 0.0, stood_at_m_ = 0.0, stands_s_ = 0.0, differs_s_ = 0.0, deviation_m_ = 0.0;
};

}  // namespace pneuservo
