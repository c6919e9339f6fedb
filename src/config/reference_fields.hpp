// The keys of each kind of reference, declared once for reader, dump, manual and parameter paths.
#pragma once
#include <array>
#include <string_view>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/core/field.hpp>

namespace pneuservo {

inline constexpr std::array<std::string_view, 8> reference_kind_names{"sine",   "multisine",    "waypoints", "sum",
                                                                      "cruise", "minimum_jerk", "file",      "live"};

/// Polynomial degrees of ramps and moves.
inline constexpr std::array<int, 5> reference_degrees{3, 5, 7, 9, 11};

/// A kind's own default of `smoothness`.
constexpr int default_smoothness(ReferenceKind kind) {
  if (kind == ReferenceKind::live) return 11;  // the sixth derivative is continuous, the highest that a law needs so
  return kind == ReferenceKind::cruise ? 9 : 5;
}

/// Limits of commanded moves, and their wait.
template <class V, class... P> void visit_live(V&& v, P&... p) {
  v(Field{"lowest_m", "m", -10, 10, "commands may go down to it"}, p.lowest_m...);
  v(Field{"highest_m", "m", -10, 10, "commands may go up to it"}, p.highest_m...);
  v(Field{"speed_mps", "m/s", 1e-4, 100, "largest speed of a commanded move"}, p.speed_mps...);
  v(Field{"acceleration_mps2", "m/s2", 1e-3, 1e5, "largest acceleration of a commanded move"}, p.acceleration_mps2...);
  v(Field{"pass_within_s", "s", 0, 10,
          "from the command of a move at rest to its begin, for its command pass (flow_feedforward: pass)",
          Presence::optional},
    p.pass_within_s...);
}

/// Visits the keys that references of `kind` have. An optional number below its range is not stated (ramp_s: one
/// period).
template <class V, class... P> void visit_reference(ReferenceKind kind, V&& v, P&... p) {
  constexpr auto required = Presence::required, optional = Presence::optional;
  const Field center{"center_m", "m", -10, 10, "mean position", optional};
  const Field start{"start_s", "s", 0, 1e6, "before it the reference rests at its first value", optional};
  const Field ramp{"ramp_s", "s", 0, 1e6, "smooth ramp; default: one period (of the slowest component)", optional};
  const Field degree{"smoothness", "-", 3, 11, "degree of the polynomial: 3, 5, 7, 9 or 11", optional};
  const Field from{"start_m", "m", -10, 10, "position before the move"};
  const Field to{"end_m", "m", -10, 10, "position after the move"};
  v(Field{"kind", "", 0, 0, "kind of reference", required, reference_kind_names}, p.kind...);
  switch (kind) {
    case ReferenceKind::sine:
      v(Field{"amplitude_m", "m", 0, 10, "A of center + r(t) A sin(2 pi f (t - start))"}, p.amplitude_m...);
      v(Field{"frequency_Hz", "Hz", 1e-4, 5e4, "f"}, p.frequency_Hz...);
      v(center, p.center_m...), v(start, p.start_s...), v(ramp, p.ramp_s...), v(degree, p.smoothness...);
      break;
    case ReferenceKind::multisine:
      v(Field{"components", "", 0, 0, "list of [amplitude_m, frequency_Hz, phase_rad], summed under one ramp"},
        p.components...);
      v(center, p.center_m...), v(start, p.start_s...), v(ramp, p.ramp_s...), v(degree, p.smoothness...);
      break;
    case ReferenceKind::waypoints:
      v(Field{"times_s", "s", 0, 1e6, "times of the points, strictly increasing"}, p.times_s...);
      v(Field{"positions_m", "m", -10, 10, "positions of the points; equal neighbours: dwell"}, p.positions_m...);
      v(degree, p.smoothness...);
      break;
    case ReferenceKind::sum: v(Field{"parts", "", 0, 0, "list of references that add up"}, p.parts...); break;
    case ReferenceKind::cruise:
      v(from, p.start_m...), v(to, p.end_m...);
      v(Field{"speed_mps", "m/s", 1e-9, 100, "constant speed between the ramps"}, p.speed_mps...);
      v(Field{"ramp_s", "s", 1e-6, 1e6, "time in which the speed rises, and falls again"}, p.ramp_s...);
      v(start, p.start_s...), v(degree, p.smoothness...);
      break;
    case ReferenceKind::minimum_jerk:
      v(from, p.start_m...), v(to, p.end_m...);
      v(Field{"duration_s", "s", 1e-6, 1e6, "length of the move"}, p.duration_s...);
      v(start, p.start_s...);
      break;
    case ReferenceKind::file:
      v(Field{"path", "", 0, 0, "recording with the columns t_s and x_ref_m, from the config's folder"}, p.path...);
      break;
    case ReferenceKind::live: visit_live(v, p...), v(degree, p.smoothness...); break;
  }
}

/// Numbers of one component of a multisine.
inline constexpr std::array<Field, 3> component_fields{Field{"amplitude_m", "m", -10, 10, "amplitude"},
                                                       Field{"frequency_Hz", "Hz", 1e-4, 5e4, "frequency"},
                                                       Field{"phase_rad", "rad", -1e6, 1e6, "phase"}};

}  // namespace pneuservo
