// The smooth move from wherever the axis is to the reference's first value.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/control/smoothstep.hpp>

namespace pneuservo {

/// From rest to rest by the smoothstep of degree 9: as many derivatives are continuous as any law feeds forward. HOT.
class Approach {
 public:
  static constexpr double speed_mps = 0.1;  ///< peak
  static constexpr double shortest_s = 0.5;
  static constexpr double peak_over_mean = 315.0 / 128.0;
  static constexpr std::size_t degree = 9;

  /// Begins at t_s; with `goes` false the axis is there already. Lasts whole periods.
  void plan(double t_s, double from_m, double to_m, bool goes, double period_s) noexcept {
    start_s_ = t_s;
    from_m_ = from_m;
    to_m_ = to_m;
    const double duration = goes ? std::max(shortest_s, peak_over_mean * std::fabs(to_m - from_m) / speed_mps) : 0.0;
    end_s_ = t_s + period_s * std::ceil(duration / period_s);
  }
  double end_s() const noexcept { return end_s_; }
  ReferencePoint at(double t_s) const noexcept {
    ReferencePoint point;
    point.d[0] = to_m_;
    if (t_s >= end_s_) return point;
    // x = from + way s(z), z = time/duration; a derivative of s by t is one by z over the duration.
    static constexpr auto smooth = smoothstep_coefficients(degree);
    const double duration = end_s_ - start_s_;
    const double z = std::clamp((t_s - start_s_) / duration, 0.0, 1.0);
    std::array<double, smoothstep_degree_max + 1> c = smooth;
    double scale = to_m_ - from_m_;
    for (std::size_t order = 0; order < point.d.size(); ++order) {
      double value = 0.0;
      for (std::size_t i = degree + 1; i-- > 0;) value = value * z + c[i];
      point.d[order] = scale * value + (order == 0 ? from_m_ : 0.0);
      for (std::size_t i = 0; i < degree; ++i) c[i] = static_cast<double>(i + 1) * c[i + 1];
      c[degree] = 0.0;
      scale /= duration;
    }
    return point;
  }

 private:
  double from_m_ = 0.0, to_m_ = 0.0, start_s_ = 0.0, end_s_ = 0.0;
};

}  // namespace pneuservo
