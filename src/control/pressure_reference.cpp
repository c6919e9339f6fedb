// The reference of a pressure.
#include <pneuservo/control/pressure_reference.hpp>

#include <algorithm>
#include <stdexcept>

namespace pneuservo {
namespace {

/// The machinery of references in Pa in place of m.
ReferenceSpec smooth_spec(const PressureReferenceParameters& p) {
  ReferenceSpec spec;
  if (p.kind == PressureReferenceKind::sine) {
    spec.kind = ReferenceKind::sine;
    spec.amplitude_m = p.amplitude_Pa;
    spec.frequency_Hz = p.frequency_Hz;
    spec.center_m = p.center_Pa;
    spec.start_s = p.start_s;
  } else if (p.kind == PressureReferenceKind::live) {
    const LiveLimits limits = live_limits(p);
    spec.kind = ReferenceKind::live;
    spec.lowest_m = limits.lowest_m;
    spec.highest_m = limits.highest_m;
    spec.speed_mps = limits.speed_mps;
    spec.acceleration_mps2 = limits.acceleration_mps2;
    spec.smoothness = limits.smoothness;
  } else {
    spec.kind = ReferenceKind::waypoints;
    spec.times_s = p.times_s;
    spec.positions_m = p.pressures_Pa;
  }
  return spec;
}

void check_live(const PressureReferenceParameters& p) {
  const double least_Pa = p.rate_Pa_per_s * p.ramp_s;
  if (!(p.highest_Pa - p.lowest_Pa >= least_Pa))
    throw std::invalid_argument("reference.highest_Pa: found " + std::to_string(p.highest_Pa) +
                                ", expected at least lowest_Pa + rate_Pa_per_s ramp_s (" +
                                std::to_string(p.lowest_Pa + least_Pa) + "), or the rate is never reached");
}

void check_points(const PressureReferenceParameters& p) {
  if (p.times_s.size() != p.pressures_Pa.size() || p.times_s.empty())
    throw std::invalid_argument("reference.pressures_Pa: found " + std::to_string(p.pressures_Pa.size()) +
                                " pressures, expected as many as times_s has (" + std::to_string(p.times_s.size()) +
                                "), at least one");
  for (std::size_t i = 1; i < p.times_s.size(); ++i)
    if (!(p.times_s[i] > p.times_s[i - 1]))
      throw std::invalid_argument("reference.times_s: found " + std::to_string(p.times_s[i]) + " after " +
                                  std::to_string(p.times_s[i - 1]) + ", expected strictly increasing times");
}

}  // namespace

// The law feeds the rate forward: degree 5 leaves it and its change continuous. 2^-20 Pa keeps sums of a stream within
// 63 bits.
LiveLimits live_limits(const PressureReferenceParameters& live) noexcept {
  LiveLimits limits{.lowest_m = live.lowest_Pa,
                    .highest_m = live.highest_Pa,
                    .speed_mps = live.rate_Pa_per_s,
                    .acceleration_mps2 = 1.0,
                    .smoothness = 5,
                    .unit_m = 0x1p-20};
  limits.acceleration_mps2 = LivePlanner::transition_s(limits) / live.ramp_s;
  return limits;
}

PressureReference::PressureReference(const PressureReferenceParameters& p)
    : has_steps_(p.kind == PressureReferenceKind::steps) {
  if (p.kind == PressureReferenceKind::live) check_live(p);
  else if (p.kind != PressureReferenceKind::sine) check_points(p);
  if (!has_steps_) {
    smooth_ = Reference(smooth_spec(p));
    end_s_ = smooth_.end_s();
    return;
  }
  times_s_ = p.times_s;
  pressures_Pa_ = p.pressures_Pa;
  end_s_ = times_s_.back();
}

ReferencePoint PressureReference::at(double t_s) const noexcept {
  if (!has_steps_) return smooth_.at(t_s);
  const auto next = std::upper_bound(times_s_.begin(), times_s_.end(), t_s);
  const auto place = std::max<std::ptrdiff_t>(next - times_s_.begin() - 1, 0);
  ReferencePoint point;
  point.d[0] = pressures_Pa_[static_cast<std::size_t>(place)];
  return point;
}

ReferenceExtremes PressureReference::range_Pa(double duration_s) const {
  if (!has_steps_) return smooth_.extremes(0, duration_s);
  const auto [low, high] = std::minmax_element(pressures_Pa_.begin(), pressures_Pa_.end());
  return {*low, *high};
}

}  // namespace pneuservo
