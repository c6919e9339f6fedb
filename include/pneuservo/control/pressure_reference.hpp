// What a pressure shall do: steps, smooth waypoints, a sine or what commands ask for, by the one machinery of
// references.
#pragma once
#include <array>
#include <string_view>
#include <vector>

#include <pneuservo/control/live_planner.hpp>
#include <pneuservo/control/reference.hpp>
#include <pneuservo/core/field.hpp>

namespace pneuservo {

enum class PressureReferenceKind { steps, waypoints, sine, live };
inline constexpr std::array<std::string_view, 4> pressure_reference_names{"steps", "waypoints", "sine", "live"};

/// As a config states it; keys that a kind does not have stay unused. Pressures are absolute.
struct PressureReferenceParameters {
  PressureReferenceKind kind = PressureReferenceKind::steps;
  std::vector<double> times_s, pressures_Pa;                 // steps, waypoints
  double amplitude_Pa = 0.0, frequency_Hz = 0.0, center_Pa = 0.0;  // sine
  double start_s = 0.0;
  double lowest_Pa = 0.0, highest_Pa = 0.0, rate_Pa_per_s = 0.0, ramp_s = 0.1;  // live

  template <class V, class First, class... Rest> static void visit(V&& v, First& first, Rest&... rest) {
    v(Field{"kind", "", 0, 0, "kind of reference", Presence::required, pressure_reference_names}, first.kind,
      rest.kind...);
    if (first.kind == PressureReferenceKind::sine) visit_sine(v, first, rest...);
    else if (first.kind == PressureReferenceKind::live) visit_live(v, first, rest...);
    else visit_points(v, first, rest...);
  }
  template <class V, class... P> static void visit_points(V& v, P&... p) {
    v(Field{"times_s", "s", 0, 1e6, "times of the points, strictly increasing"}, p.times_s...);
    v(Field{"pressures_Pa", "Pa", 1e4, 2e6, "absolute; steps: from each time on; waypoints: smooth between the times"},
      p.pressures_Pa...);
  }
  template <class V, class... P> static void visit_live(V& v, P&... p) {
    v(Field{"lowest_Pa", "Pa", 1e4, 2e6, "commands may go down to it, absolute"}, p.lowest_Pa...);
    v(Field{"highest_Pa", "Pa", 1e4, 2e6, "commands may go up to it, absolute"}, p.highest_Pa...);
    v(Field{"rate_Pa_per_s", "Pa/s", 1, 1e9, "largest rate of a commanded change"}, p.rate_Pa_per_s...);
    v(Field{"ramp_s", "s", 1e-3, 1e3, "time in which the largest rate is gained, and lost again", Presence::optional},
      p.ramp_s...);
  }
  template <class V, class... P> static void visit_sine(V& v, P&... p) {
    v(Field{"amplitude_Pa", "Pa", 0, 1e6,
            "A of center + r(t) A sin(2 pi f (t - start)), r a smooth ramp of one period"},
      p.amplitude_Pa...);
    v(Field{"frequency_Hz", "Hz", 1e-4, 1e3, "f"}, p.frequency_Hz...);
    v(Field{"center_Pa", "Pa", 1e4, 2e6, "mean pressure, absolute"}, p.center_Pa...);
    v(Field{"start_s", "s", 0, 1e6, "before it the reference rests at its center", Presence::optional}, p.start_s...);
  }
};

/// Limits of commands of kind `live`, Pa in place of m.
LiveLimits live_limits(const PressureReferenceParameters& live) noexcept;

/// The reference of a pressure: value [Pa] and derivatives at any time. Built once (cold), then HOT.
class PressureReference {
 public:
  PressureReference() = default;
  /// Throws std::invalid_argument where lengths or times contradict each other.
  explicit PressureReference(const PressureReferenceParameters& parameters);

  /// d[0] = p [Pa], d[i] its i-th derivative. A step counts from its time on.
  ReferencePoint at(double t_s) const noexcept;
  /// Time of the last point; infinity for a sine.
  double end_s() const noexcept { return end_s_; }
  /// Smallest and largest pressure: of steps of all, else over [0, duration_s]; cold.
  ReferenceExtremes range_Pa(double duration_s) const;
  /// The smooth part; of steps nothing.
  const Reference& smooth() const noexcept { return smooth_; }

 private:
  bool has_steps_ = false;
  std::vector<double> times_s_, pressures_Pa_;
  Reference smooth_;
  double end_s_ = 0.0;
};

}  // namespace pneuservo
