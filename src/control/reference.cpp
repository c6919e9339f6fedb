// References at run time: evaluation of polynomial pieces and ramped sines, and their extremes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <pneuservo/control/live_planner.hpp>
#include <pneuservo/control/reference.hpp>

namespace pneuservo {

namespace {
constexpr std::array<double, 8> factorial{1, 1, 2, 6, 24, 120, 720, 5040};
constexpr int orders = 8;

/// Derivatives 0 to 7 of (a b), both given by their derivatives (Leibniz).
std::array<double, 8> product(const std::array<double, 8>& a, const std::array<double, 8>& b) noexcept {
  std::array<double, 8> out{};
  for (std::size_t order = 0; order < orders; ++order) {
    double binomial = 1.0;
    for (std::size_t k = 0; k <= order; ++k) {
      out[order] += binomial * a[k] * b[order - k];
      binomial = binomial * static_cast<double>(order - k) / static_cast<double>(k + 1);
    }
  }
  return out;
}

/// After which sines of these rates repeat; 0 without one, infinity where none is known.
double common_period_s(const auto& components) {
  if (components.empty()) return 0.0;
  double slowest = std::numeric_limits<double>::infinity();
  for (const auto& c : components) slowest = std::min(slowest, std::fabs(c.rate_rad_per_s));
  constexpr int most_periods = 100;  // of the slowest: frequencies of two digits meet within them
  constexpr double rounding = 1e-9;  // of a ratio of frequencies that are written in decimals
  for (int periods = 1; periods <= most_periods; ++periods) {
    const bool all_repeat = std::ranges::all_of(components, [&](const auto& c) {
      const double turns = periods * std::fabs(c.rate_rad_per_s) / slowest;
      return std::fabs(turns - std::round(turns)) < rounding * turns;
    });
    if (all_repeat) return periods * 2.0 * M_PI / slowest;
  }
  return std::numeric_limits<double>::infinity();
}
}  // namespace

void Reference::evaluate(const Track& track, double t_s, Derivatives& d) const noexcept {
  d = {};
  if (!(t_s >= track.begin_s)) {
    d[0] = track.first_value;
    return;
  }
  if (t_s >= track.end_s) {
    d[0] = track.last_value;
    return;
  }
  const Piece* begin = pieces_.data() + track.first_piece;
  const Piece* piece = std::upper_bound(begin, begin + track.pieces - 1, t_s,
                                        [](double t, const Piece& p) noexcept { return t < p.end_s; });
  const double w = (t_s - piece->origin_s) * piece->rate_per_s;
  // Horner's scheme for the value and all Taylor coefficients at once.
  for (std::uint32_t i = piece->coefficients; i-- > 0;) {
    for (std::size_t k = orders - 1; k > 0; --k) d[k] = d[k] * w + d[k - 1];
    d[0] = d[0] * w + coefficients_[piece->first_coefficient + i];
  }
  double rate = 1.0;
  for (std::size_t k = 1; k < orders; ++k) {
    rate *= piece->rate_per_s;
    d[k] *= factorial[k] * rate;
  }
}

void Reference::add(const Oscillation& oscillation, double t_s, Derivatives& d) const noexcept {
  const double elapsed_s = std::max(t_s - oscillation.start_s, 0.0);
  const bool moving = t_s >= oscillation.start_s;
  Derivatives sum{};
  for (std::uint32_t i = 0; i < oscillation.components; ++i) {
    const Component& c = components_[oscillation.first_component + i];
    const double angle = c.rate_rad_per_s * elapsed_s + c.phase_rad;
    const double sine = std::sin(angle), cosine = std::cos(angle);
    const std::array<double, 4> cycle{sine, cosine, -sine, -cosine};
    double amplitude = c.amplitude_m;
    for (std::size_t k = 0; k < orders; ++k) {
      sum[k] += amplitude * cycle[k % 4];
      amplitude *= c.rate_rad_per_s;
    }
  }
  if (!moving) std::fill(sum.begin() + 1, sum.end(), 0.0);
  if (t_s < oscillation.ramp.end_s) {
    Derivatives ramp;
    evaluate(oscillation.ramp, t_s, ramp);
    sum = product(ramp, sum);
  }
  for (std::size_t k = 0; k < orders; ++k) d[k] += sum[k];
  d[0] += oscillation.center_m;
}

Reference::Reference(std::shared_ptr<const LivePlanner> planned)
    : planned_(std::move(planned)), end_s_(static_cast<double>(planned_->end_tick()) * planned_->period_s()) {}

ReferencePoint Reference::at(double t_s) const noexcept {
  if (planned_) return planned_->at(0, t_s / planned_->period_s());
  ReferencePoint point;
  for (const Track& track : tracks_) {
    Derivatives d;
    evaluate(track, t_s, d);
    for (std::size_t k = 0; k < orders; ++k) point.d[k] += d[k];
  }
  for (const Oscillation& oscillation : oscillations_) add(oscillation, t_s, point.d);
  return point;
}

Reference::Repetition Reference::repetition() const {
  Repetition out{planned_ ? end_s_ : 0.0, common_period_s(components_)};
  for (const Track& t : tracks_) out.from_s = std::max(out.from_s, t.end_s);
  for (const Oscillation& o : oscillations_) out.from_s = std::max({out.from_s, o.start_s, o.ramp.end_s});
  return out;
}

ReferenceExtremes Reference::extremes(int order, double duration_s) const {
  const auto n = static_cast<std::size_t>(order);
  // From then on it rests or repeats what was before; just beyond, so that the end of a piece lies within.
  const Repetition repeated = repetition();
  const double known_s = repeated.from_s + repeated.period_s;
  if (known_s > 0.0) duration_s = std::min(duration_s, std::nextafter(known_s, 2.0 * known_s));
  double step_s = duration_s / 1000.0;
  for (const Component& c : components_)
    step_s = std::min(step_s, 2.0 * M_PI / (40.0 * (std::fabs(c.rate_rad_per_s) + 1e-9)));
  for (const Piece& p : pieces_) step_s = std::min(step_s, 1.0 / (40.0 * std::fabs(p.rate_per_s)));
  const auto samples = static_cast<std::int64_t>(std::min(duration_s / step_s, 2e6)) + 1;

  std::vector<double> times{0.0, duration_s};
  for (std::int64_t i = 1; i < samples; ++i)
    times.push_back(duration_s * static_cast<double>(i) / static_cast<double>(samples));
  for (const Piece& p : pieces_)
    if (p.end_s > 0.0 && p.end_s < duration_s) times.insert(times.end(), {p.end_s, std::nextafter(p.end_s, 0.0)});
  for (const Track& t : tracks_)
    if (t.begin_s > 0.0 && t.begin_s < duration_s) times.push_back(t.begin_s);
  for (const Oscillation& o : oscillations_)
    if (o.start_s > 0.0 && o.start_s < duration_s) times.push_back(o.start_s);
  std::sort(times.begin(), times.end());

  ReferenceExtremes out{at(0.0).d[n], at(0.0).d[n]};
  double before_s = 0.0, slope_before = at(0.0).d[n + 1];
  for (const double t : times) {
    const ReferencePoint point = at(t);
    out.minimum = std::min(out.minimum, point.d[n]);
    out.maximum = std::max(out.maximum, point.d[n]);
    if (slope_before * point.d[n + 1] < 0.0) {  // a turning point lies between: bisect its slope
      double low = before_s, high = t;
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (at(middle).d[n + 1] * slope_before > 0.0 ? low : high) = middle;
      }
      const double value = at(low).d[n];
      out.minimum = std::min(out.minimum, value);
      out.maximum = std::max(out.maximum, value);
    }
    before_s = t;
    slope_before = point.d[n + 1];
  }
  return out;
}

ReferenceExtremes reference_range_m(const ReferenceSpec& spec, double duration_s, const LoadPositions& load) {
  return Reference(spec, load).extremes(0, duration_s);
}

double reference_peak_speed_mps(const ReferenceSpec& spec, double duration_s, const LoadPositions& load) {
  const ReferenceExtremes velocity = Reference(spec, load).extremes(1, duration_s);
  return std::max(std::fabs(velocity.minimum), std::fabs(velocity.maximum));
}

}  // namespace pneuservo
