// References from their description: every kind becomes polynomial pieces and ramped sines in flat storage.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/core.h>

#include <pneuservo/control/live_planner.hpp>
#include <pneuservo/control/reference.hpp>
#include <pneuservo/control/smoothstep.hpp>

#include "control/interpolation.hpp"

namespace pneuservo {

namespace {
[[noreturn]] void reject(const std::string& sentence) { throw std::invalid_argument("reference: " + sentence); }

void require(bool condition, const std::string& sentence) {
  if (!condition) reject(sentence);
}
void require_finite(std::initializer_list<std::pair<const char*, double>> values) {
  for (const auto& [key, value] : values)
    require(std::isfinite(value), fmt::format("{} is {}, expected a number", key, value));
}
void require_degree(int smoothness) {
  require(is_smoothstep_degree(smoothness), fmt::format("smoothness is {}, expected 3, 5, 7, 9 or 11", smoothness));
}
/// Times at which something stands: finite, strictly increasing, as many as positions.
void require_samples(const std::vector<double>& times_s, const std::vector<double>& positions_m,
                     const std::string& where) {
  require(times_s.size() == positions_m.size(),
          fmt::format("{}{} times and {} positions, expected as many of one as of the other", where, times_s.size(),
                      positions_m.size()));
  require(times_s.size() >= 2, fmt::format("{}{} points, expected at least 2", where, times_s.size()));
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    require(std::isfinite(times_s[i]) && std::isfinite(positions_m[i]),
            fmt::format("{}point {} is ({}, {}), expected numbers", where, i + 1, times_s[i], positions_m[i]));
    require(i == 0 || times_s[i] > times_s[i - 1],
            fmt::format("{}time {} is {} s after {} s, expected increasing times", where, i + 1, times_s[i],
                        times_s[i > 0 ? i - 1 : 0]));
  }
}
}  // namespace

namespace {

/// Commanded moves one after the other, as a sum of moves.
class LiveMoves {
 public:
  explicit LiveMoves(const ReferenceSpec& live) : live_(live), ramp_s_(LivePlanner::transition_s(live_limits(live))) {
    moves_.kind = ReferenceKind::sum;
  }
  /// At the largest speed; the next one begins `takes_s` later.
  void go(double from_m, double to_m, double takes_s) {
    ReferenceSpec part;
    part.kind = ReferenceKind::cruise;
    part.start_m = from_m;
    part.end_m = to_m;
    part.speed_mps = live_.speed_mps;
    part.ramp_s = ramp_s_;
    part.smoothness = live_.smoothness;
    part.start_s = begin_s_;
    moves_.parts.push_back(part);
    begin_s_ += takes_s;
  }
  /// Over the whole range.
  double widest_s() const { return (live_.highest_m - live_.lowest_m) / live_.speed_mps + ramp_s_; }
  double ramp_s() const { return ramp_s_; }
  const ReferenceSpec& moves() const { return moves_; }

 private:
  const ReferenceSpec& live_;
  double ramp_s_, begin_s_ = live_rest_s;
  ReferenceSpec moves_;
};

}  // namespace

ReferenceSpec live_trial(const ReferenceSpec& live) {
  require_finite({{"lowest_m", live.lowest_m}, {"highest_m", live.highest_m}});
  require_degree(live.smoothness);
  require(live.speed_mps > 0.0 && live.acceleration_mps2 > 0.0,
          fmt::format("speed_mps is {} and acceleration_mps2 {}, expected more than 0", live.speed_mps,
                      live.acceleration_mps2));
  LiveMoves trial(live);
  const double range_m = live.highest_m - live.lowest_m, reached_m = trial.ramp_s() * live.speed_mps;
  require(
      range_m >= reached_m,
      fmt::format("between lowest_m {:.6g} and highest_m {:.6g} speed_mps {} is not reached with acceleration_mps2 {}, "
                  "expected at least {:.4g} m between them, more acceleration or less speed",
                  live.lowest_m, live.highest_m, live.speed_mps, live.acceleration_mps2, reached_m));
  const double shortest_s = 2.0 * trial.ramp_s();
  trial.go(live.lowest_m, live.highest_m, trial.widest_s());
  trial.go(0.0, -range_m, trial.widest_s() + live_rest_s);
  trial.go(0.0, reached_m * (1.0 + 1e-12), shortest_s);
  trial.go(0.0, -reached_m * (1.0 + 1e-12), shortest_s);
  return trial.moves();
}

ReferenceSpec live_moves(const ReferenceSpec& live) {
  LiveMoves moves(live);
  moves.go(live.lowest_m, live.highest_m, moves.widest_s() + live_rest_s);
  moves.go(0.0, live.lowest_m - live.highest_m, 0.0);
  return moves.moves();
}

/// Appends to a reference; each function checks its own part of the description.
struct Reference::Builder {
  Reference& out;
  const LoadPositions& load;
  bool moves = false;

  void append(const ReferenceSpec& spec) {
    switch (spec.kind) {
      case ReferenceKind::sine: return oscillation(spec, {{spec.amplitude_m, spec.frequency_Hz, 0.0}});
      case ReferenceKind::multisine: return oscillation(spec, spec.components);
      case ReferenceKind::waypoints: return waypoints(spec.times_s, spec.positions_m, spec.smoothness);
      case ReferenceKind::sum: return sum(spec);
      case ReferenceKind::cruise: return cruise(spec);
      case ReferenceKind::minimum_jerk: return minimum_jerk(spec);
      case ReferenceKind::file: return file(spec);
      case ReferenceKind::live: return sum(live_trial(spec));
    }
    reject("unknown kind");
  }

  void sum(const ReferenceSpec& spec) {
    require(!spec.parts.empty(), "parts is empty, expected at least one reference");
    for (const ReferenceSpec& part : spec.parts) append(part);
  }

  // --- sines --------------------------------------------------------------------------------
  void oscillation(const ReferenceSpec& spec, const std::vector<std::array<double, 3>>& components) {
    require_finite({{"center_m", spec.center_m}, {"start_s", spec.start_s}, {"ramp_s", spec.ramp_s}});
    require_degree(spec.smoothness);
    require(!components.empty(), "components is empty, expected at least one [amplitude_m, frequency_Hz, phase_rad]");
    Oscillation o{spec.center_m,
                  spec.start_s,
                  {},
                  static_cast<std::uint32_t>(out.components_.size()),
                  static_cast<std::uint32_t>(components.size())};
    double slowest_Hz = infinite;
    bool amplitude = false;
    for (const auto& [amplitude_m, frequency_Hz, phase_rad] : components) {
      require_finite({{"amplitude_m", amplitude_m}, {"frequency_Hz", frequency_Hz}, {"phase_rad", phase_rad}});
      require(frequency_Hz > 0.0, fmt::format("frequency_Hz is {}, expected more than 0", frequency_Hz));
      slowest_Hz = std::min(slowest_Hz, frequency_Hz);
      amplitude = amplitude || amplitude_m != 0.0;
      out.components_.push_back({amplitude_m, 2.0 * M_PI * frequency_Hz, phase_rad});
    }
    const double ramp_s = spec.ramp_s < 0.0 ? 1.0 / slowest_Hz : spec.ramp_s;
    o.ramp = open_track(spec.start_s, ramp_s > 0.0 ? 0.0 : 1.0);
    if (ramp_s > 0.0) step(o.ramp, spec.start_s, ramp_s, 0.0, 1.0, spec.smoothness);
    out.oscillations_.push_back(o);
    if (amplitude) motion(spec.start_s, infinite);
  }

  // --- moves --------------------------------------------------------------------------------
  void waypoints(const std::vector<double>& times_s, const std::vector<double>& positions_m, int smoothness) {
    require_samples(times_s, positions_m, "waypoints: ");
    require_degree(smoothness);
    Track track = open_track(times_s.front(), positions_m.front());
    for (std::size_t i = 1; i < times_s.size(); ++i) {
      step(track, times_s[i - 1], times_s[i] - times_s[i - 1], positions_m[i - 1], positions_m[i], smoothness);
      set_end(track, times_s[i], positions_m[i]);
      if (positions_m[i] != positions_m[i - 1]) motion(times_s[i - 1], times_s[i]);
    }
    out.tracks_.push_back(track);
  }

  void minimum_jerk(const ReferenceSpec& spec) {
    require_finite({{"start_m", spec.start_m}, {"end_m", spec.end_m}, {"start_s", spec.start_s}});
    require(std::isfinite(spec.duration_s) && spec.duration_s > 0.0,
            fmt::format("duration_s of the move is {}, expected more than 0", spec.duration_s));
    waypoints({spec.start_s, spec.start_s + spec.duration_s}, {spec.start_m, spec.end_m}, spec.smoothness);
  }

  /// Speed V s(t/ramp) up, constant, mirrored down: position V ramp I(z), I the integral of the smoothstep, I(1) = 1/2.
  void cruise(const ReferenceSpec& spec) {
    require_finite({{"start_m", spec.start_m}, {"end_m", spec.end_m}, {"start_s", spec.start_s}});
    require(std::isfinite(spec.speed_mps) && spec.speed_mps > 0.0,
            fmt::format("speed_mps is {}, expected more than 0 (the direction follows from start_m and end_m)",
                        spec.speed_mps));
    require(std::isfinite(spec.ramp_s) && spec.ramp_s > 0.0,
            fmt::format("ramp_s is {}, expected more than 0", spec.ramp_s));
    require_degree(spec.smoothness);
    const double distance_m = spec.end_m - spec.start_m, travel_s = std::fabs(distance_m) / spec.speed_mps;
    require(travel_s >= spec.ramp_s || distance_m == 0.0,
            fmt::format("speed_mps {} is never reached between start_m {} and end_m {} with ramp_s {}, expected ramp_s "
                        "of at most {}",
                        spec.speed_mps, spec.start_m, spec.end_m, spec.ramp_s, travel_s));
    Track track = open_track(spec.start_s, spec.start_m);
    if (distance_m != 0.0) {
      const double t0 = spec.start_s, t1 = t0 + spec.ramp_s, t2 = t0 + travel_s, t3 = t2 + spec.ramp_s;
      const double v = std::copysign(spec.speed_mps, distance_m), gain_m = v * spec.ramp_s;
      const std::vector<double> from_rest = speed_ramp(gain_m, spec.smoothness);
      // Near full speed the speed ramp is 1 - s(w): I(1 - w) = 1/2 - w + I(w).
      const auto to_speed = [&](double at_m, double sign) {
        std::vector<double> c = from_rest;
        for (double& value : c) value *= sign;
        c[0] += at_m;
        c[1] -= sign * gain_m;
        return c;
      };
      const double half_s = 0.5 * spec.ramp_s, rate = 1.0 / spec.ramp_s;
      const double reached_m = spec.start_m + 0.5 * gain_m, leaving_m = spec.end_m - 0.5 * gain_m;
      piece(track, t0 + half_s, t0, rate, shifted(from_rest, spec.start_m, 1.0));
      piece(track, t1, t1, -rate, to_speed(reached_m, 1.0));
      if (t2 > t1) piece(track, t2, t1, 1.0, std::vector<double>{reached_m, v});
      piece(track, t2 + half_s, t2, rate, to_speed(leaving_m, -1.0));
      piece(track, t3, t3, -rate, shifted(from_rest, spec.end_m, -1.0));
      set_end(track, t3, spec.end_m);
      motion(t0, t3);
    }
    out.tracks_.push_back(track);
  }

  void file(const ReferenceSpec& spec) {
    require(!spec.path.empty(), "path is empty, expected a recording with columns t_s and x_ref_m");
    require(static_cast<bool>(load), fmt::format("{}: no reader of recordings is at hand here", spec.path));
    const auto [times_s, positions_m] = load(spec.path);
    require_samples(times_s, positions_m, spec.path + ": ");
    Track track = open_track(times_s.front(), positions_m.front());
    const std::vector<std::array<double, 8>> pieces = interpolate_septic(times_s, positions_m);
    for (std::size_t i = 0; i < pieces.size(); ++i)
      piece(track, times_s[i + 1], times_s[i], 1.0 / (times_s[i + 1] - times_s[i]),
            std::vector<double>(pieces[i].begin(), pieces[i].end()));
    set_end(track, times_s.back(), positions_m.back());
    for (std::size_t i = 1; i < times_s.size(); ++i)
      if (positions_m[i] != positions_m[i - 1]) motion(times_s[i - 1], times_s[i]);
    out.tracks_.push_back(track);
  }

  // --- pieces -------------------------------------------------------------------------------
  Track open_track(double begin_s, double value) const {
    return {begin_s, begin_s, value, value, static_cast<std::uint32_t>(out.pieces_.size()), 0};
  }
  static void set_end(Track& track, double end_s, double value) {
    track.end_s = end_s;
    track.last_value = value;
  }
  void motion(double from_s, double to_s) {
    out.start_s_ = moves ? std::min(out.start_s_, from_s) : from_s;
    out.end_s_ = moves ? std::max(out.end_s_, to_s) : to_s;
    moves = true;
  }
  void piece(Track& track, double end_s, double origin_s, double rate_per_s, const std::vector<double>& coefficients) {
    out.pieces_.push_back({end_s, origin_s, rate_per_s, static_cast<std::uint32_t>(out.coefficients_.size()),
                           static_cast<std::uint32_t>(coefficients.size())});
    out.coefficients_.insert(out.coefficients_.end(), coefficients.begin(), coefficients.end());
    ++track.pieces;
  }
  /// Rest-to-rest polynomial; the second half runs from the far end, so that both ends are exact.
  void step(Track& track, double from_s, double duration_s, double from, double to, int degree) {
    if (to == from) return dwell(track, from_s + duration_s, from);
    const auto s = smoothstep_coefficients(degree);
    std::vector<double> c(s.begin(), s.begin() + degree + 1);
    for (double& value : c) value *= to - from;
    const double to_s = from_s + duration_s, rate = 1.0 / duration_s;
    piece(track, from_s + 0.5 * duration_s, from_s, rate, shifted(c, from, 1.0));
    piece(track, to_s, to_s, -rate, shifted(c, to, -1.0));
    set_end(track, to_s, to);
  }
  void dwell(Track& track, double until_s, double position) {
    piece(track, until_s, until_s, 1.0, std::vector<double>{position});
    set_end(track, until_s, position);
  }
  static std::vector<double> shifted(std::vector<double> c, double offset, double sign) {
    for (double& value : c) value *= sign;
    c[0] += offset;
    return c;
  }
  /// gain times the integral of the smoothstep.
  static std::vector<double> speed_ramp(double gain, int degree) {
    const auto s = smoothstep_coefficients(degree);
    std::vector<double> c(static_cast<std::size_t>(degree) + 2, 0.0);
    for (std::size_t i = 0; i <= static_cast<std::size_t>(degree); ++i)
      c[i + 1] = gain * s[i] / static_cast<double>(i + 1);
    return c;
  }
  static constexpr double infinite = std::numeric_limits<double>::infinity();
};

Reference::Reference(const ReferenceSpec& spec, const LoadPositions& load) { Builder{*this, load}.append(spec); }

}  // namespace pneuservo
