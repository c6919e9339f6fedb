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
  } else {
    spec.kind = ReferenceKind::waypoints;
    spec.times_s = p.times_s;
    spec.positions_m = p.pressures_Pa;
  }
  return spec;
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

PressureReference::PressureReference(const PressureReferenceParameters& p)
    : has_steps_(p.kind == PressureReferenceKind::steps) {
  if (p.kind != PressureReferenceKind::sine) check_points(p);
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
