// Where a rig's position comes from: an encoder, or the observer between two switches.
#pragma once
#include <array>
#include <optional>
#include <string_view>

#include <pneuservo/core/field.hpp>

namespace pneuservo {

enum class PositionSource { encoder, estimated };
inline constexpr std::array<std::string_view, 2> position_source_names{"encoder", "estimated"};

/// Switches along the way: the low one is on below low_m, the high one above high_m; each is off again hysteresis_m
/// nearer to the middle. The simulated machine has them where they are stated.
struct PositionParameters {
  PositionSource source = PositionSource::encoder;
  double low_m = 0.0, high_m = 0.0;
  double hysteresis_m = 0.0;
  double repeatability_m = 2e-4;
  double start_m = 0.0;
  double start_deviation_m = 5e-4;
  double leak_kgps = 2e-6;
  std::optional<double> unknown_force_N;
  double bound_max_m = 0.02;

  bool is_estimated() const noexcept { return source == PositionSource::estimated; }
  bool has_switches() const noexcept { return low_m < high_m; }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"source", "", 0, 0, "estimated: from air, force and two switches, without an encoder", optional,
            position_source_names},
      p.source...);
    v(Field{"low_m", "m", -10, 10, "the low switch is on below this position", optional}, p.low_m...);
    v(Field{"high_m", "m", -10, 10, "the high switch is on above this position", optional}, p.high_m...);
    v(Field{"hysteresis_m", "m", 0, 0.1, "a switch is off again this much nearer to the middle", optional},
      p.hysteresis_m...);
    v(Field{"repeatability_m", "m", 1e-6, 0.01, "standard deviation of the place where a switch changes", optional},
      p.repeatability_m...);
    v(Field{"start_m", "m", -10, 10, "where the slider stands as a run begins, as against an end stop", optional},
      p.start_m...);
    v(Field{"start_deviation_m", "m", 1e-6, 0.1, "standard deviation of start_m", optional}, p.start_deviation_m...);
    v(Field{"leak_kgps", "kg/s", 0, 1e-3, "standard deviation of what leaks out of a side unknown", optional},
      p.leak_kgps...);
    v(Field{"unknown_force_N", "N", 0, 1e6,
            "standard deviation of forces that nothing tells of; default: half of limits.dry_friction_max_N", optional},
      p.unknown_force_N...);
    v(Field{"bound_max_m", "m", 1e-4, 1, "a run ends where the position is known less well than this", optional},
      p.bound_max_m...);
  }
};

}  // namespace pneuservo
