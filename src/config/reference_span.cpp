// Where a reference goes and how long it lasts: what a config is checked against before anything moves.
#include "config/reference_span.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pneuservo {

namespace {

constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();

/// Polynomial of odd degree 2n + 1 from 0 to 1 with n zero derivatives at both ends:
/// s^(n+1) sum_k C(n+k, k) (1 - s)^k.
double smoothstep(double s, int degree) {
  if (s <= 0.0) return 0.0;
  if (s >= 1.0) return 1.0;
  const int n = (degree - 1) / 2;
  double sum = 0.0, term = 1.0;
  for (int k = 0; k <= n; ++k) {
    sum += term;
    term *= (1.0 - s) * (n + k + 1) / (k + 1);
  }
  return std::pow(s, n + 1) * sum;
}

/// Integral of smoothstep from 0 to s, by Gauss-Legendre quadrature that is exact for degree 11.
double smoothstep_integral(double s, int degree) {
  constexpr double node[6] = {-0.932469514203152028, -0.661209386466264514, -0.238619186083196909,
                              0.238619186083196909,  0.661209386466264514,  0.932469514203152028};
  constexpr double weight[6] = {0.171324492379170345, 0.360761573048138608, 0.467913934572691047,
                                0.467913934572691047, 0.360761573048138608, 0.171324492379170345};
  double sum = 0.0;
  for (int i = 0; i < 6; ++i) sum += weight[i] * smoothstep(0.5 * s * (1.0 + node[i]), degree);
  return 0.5 * s * sum;
}

double slowest_period_s(const ReferenceSpec& r) {
  if (r.kind == ReferenceKind::sine) return 1.0 / r.frequency_Hz;
  double slowest = std::numeric_limits<double>::infinity();
  for (const auto& component : r.components) slowest = std::min(slowest, component[1]);
  return 1.0 / slowest;
}

double ramp_s(const ReferenceSpec& r) { return r.ramp_s < 0.0 ? slowest_period_s(r) : r.ramp_s; }

double wave_m(const ReferenceSpec& r, double t) {
  // Before its start it rests at its first value: the centre, or without a ramp where the phases put it.
  const double since = std::max(t - r.start_s, 0.0), ramp = ramp_s(r);
  double wave = 0.0;
  if (r.kind == ReferenceKind::sine) wave = r.amplitude_m * std::sin(2.0 * std::numbers::pi * r.frequency_Hz * since);
  for (const auto& [amplitude, frequency, phase] : r.components)
    wave += amplitude * std::sin(2.0 * std::numbers::pi * frequency * since + phase);
  return r.center_m + (ramp > 0.0 ? smoothstep(since / ramp, r.smoothness) : 1.0) * wave;
}

double waypoint_m(const ReferenceSpec& r, double t) {
  const auto next = std::upper_bound(r.times_s.begin(), r.times_s.end(), t);
  if (next == r.times_s.begin()) return r.positions_m.front();
  if (next == r.times_s.end()) return r.positions_m.back();
  const std::size_t i = static_cast<std::size_t>(next - r.times_s.begin());
  const double s = (t - r.times_s[i - 1]) / (r.times_s[i] - r.times_s[i - 1]);
  return r.positions_m[i - 1] + (r.positions_m[i] - r.positions_m[i - 1]) * smoothstep(s, r.smoothness);
}

double cruise_m(const ReferenceSpec& r, double t) {
  const double distance = std::fabs(r.end_m - r.start_m), way_s = distance / r.speed_mps;
  const double since = std::clamp(t - r.start_s, 0.0, way_s + r.ramp_s);
  // The speed is the difference of two steps, one at the start and one at way_s.
  const auto travelled = [&](double time) {
    if (time <= 0.0) return 0.0;
    const double in_ramp = smoothstep_integral(std::min(time / r.ramp_s, 1.0), r.smoothness);
    return r.ramp_s * in_ramp + std::max(time - r.ramp_s, 0.0);
  };
  return r.start_m + std::copysign(r.speed_mps * (travelled(since) - travelled(since - way_s)), r.end_m - r.start_m);
}

}  // namespace

double reference_position_m(const ReferenceSpec& r, double t_s) {
  switch (r.kind) {
    case ReferenceKind::sine:
    case ReferenceKind::multisine: return wave_m(r, t_s);
    case ReferenceKind::waypoints: return waypoint_m(r, t_s);
    case ReferenceKind::cruise: return cruise_m(r, t_s);
    case ReferenceKind::minimum_jerk:
      return r.start_m + (r.end_m - r.start_m) * smoothstep((t_s - r.start_s) / r.duration_s, 5);
    case ReferenceKind::sum: {
      double sum = 0.0;
      for (const ReferenceSpec& part : r.parts) sum += reference_position_m(part, t_s);
      return sum;
    }
    case ReferenceKind::file: break;
  }
  return nowhere;
}

double reference_end_s(const ReferenceSpec& r) {
  switch (r.kind) {
    case ReferenceKind::sine:
    case ReferenceKind::multisine: return r.start_s + ramp_s(r) + 10.0 * slowest_period_s(r);
    case ReferenceKind::waypoints: return r.times_s.back();
    case ReferenceKind::cruise: return r.start_s + std::fabs(r.end_m - r.start_m) / r.speed_mps + r.ramp_s;
    case ReferenceKind::minimum_jerk: return r.start_s + r.duration_s;
    case ReferenceKind::sum: {
      double end = 0.0;
      for (const ReferenceSpec& part : r.parts) {
        const double part_end = reference_end_s(part);
        end = std::isnan(part_end) ? part_end : std::max(end, part_end);
        if (std::isnan(end)) break;
      }
      return end;
    }
    case ReferenceKind::file: break;
  }
  return nowhere;
}

bool is_periodic(const ReferenceSpec& r) {
  if (r.kind == ReferenceKind::sum) return std::any_of(r.parts.begin(), r.parts.end(), is_periodic);
  return r.kind == ReferenceKind::sine || r.kind == ReferenceKind::multisine;
}

}  // namespace pneuservo
