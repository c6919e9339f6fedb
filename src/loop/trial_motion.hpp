// What every simulated machine of a config is asked for: an approach, then the reference.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <pneuservo/loop/approach.hpp>
#include <pneuservo/loop/motion_twin.hpp>

namespace pneuservo {

/// The reference as a run asks for it, from a start beside its first value. `reference` must outlive it.
class TrialMotion {
 public:
  TrialMotion(const Rig& rig, const Reference& reference, const MotionTwin& twin)
      : reference_(reference), period_s_(rig.period_s), lead_s_(twin.law().lead_s()) {
    const double way_m = approach_share_of_stroke * rig.axis.cylinder.stroke_m, p_1 = rig.initial.pressure_1_Pa;
    end_m = reference.at(0.0).d[0];
    start_m = end_m > 0.0 ? end_m - way_m : end_m + way_m;
    approach_.plan(0.0, start_m, end_m, true, period_s_);
    reference_tick = std::llround((approach_.end_s() + twin.law().rest_s(true, {p_1, p_1})) / period_s_);
    last_tick = reference_tick + std::llround(std::min(rig.duration_s, longest_s) / period_s_);
  }
  ControlInput at(std::int64_t tick) const noexcept {
    ControlInput in;
    const double t_s = static_cast<double>(tick) * period_s_;
    in.now = in.ahead = point(t_s);
    if (lead_s_ > 0.0) in.ahead = point(t_s + lead_s_);
    in.tick = tick - reference_tick;
    return in;
  }
  double start_m = 0.0, end_m = 0.0;
  std::int64_t reference_tick = 0, last_tick = 0;

 private:
  static constexpr double longest_s = 30.0;  ///< of the reference
  /// Enough for the approach's full speed on a long stroke.
  static constexpr double approach_share_of_stroke = 0.15;

  ReferencePoint point(double t_s) const noexcept {
    const double from_s = static_cast<double>(reference_tick) * period_s_;
    return t_s >= from_s ? reference_.at(t_s - from_s) : approach_.at(t_s);
  }
  const Reference& reference_;
  double period_s_, lead_s_;
  Approach approach_;
};

/// A machine at rest there, in the config's initial pressures.
inline void start_at(MotionTwin& twin, const Rig& rig, double position_m) {
  const double p_1 = rig.initial.pressure_1_Pa;
  twin.start(position_m, {p_1, rig.initial.pressure_2_Pa.value_or(balancing_pressure_2(rig.axis, p_1))},
             safe_commands_V(rig));
}

}  // namespace pneuservo
