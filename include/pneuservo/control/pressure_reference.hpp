// What a pressure shall do: steps, smooth waypoints or a sine, by the one machinery of references.
#pragma once
#include <array>
#include <string_view>
#include <vector>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/core/field.hpp>

namespace pneuservo {

enum class PressureReferenceKind { steps, waypoints, sine };
inline constexpr std::array<std::string_view, 3> pressure_reference_names{"steps", "waypoints", "sine"};

/// As a config states it; keys that a kind does not have stay unused. Pressures are absolute.
struct PressureReferenceParameters {
  PressureReferenceKind kind = PressureReferenceKind::steps;
  std::vector<double> times_s, pressures_Pa;                 // steps, waypoints
  double amplitude_Pa = 0.0, frequency_Hz = 0.0, center_Pa = 0.0;  // sine
  double start_s = 0.0;

  template <class V, class First, class... Rest> static void visit(V&& v, First& first, Rest&... rest) {
    v(Field{"kind", "", 0, 0, "kind of reference", Presence::required, pressure_reference_names}, first.kind,
      rest.kind...);
    if (first.kind == PressureReferenceKind::sine) visit_sine(v, first, rest...);
    else visit_points(v, first, rest...);
  }
  template <class V, class... P> static void visit_points(V& v, P&... p) {
    v(Field{"times_s", "s", 0, 1e6, "times of the points, strictly increasing"}, p.times_s...);
    v(Field{"pressures_Pa", "Pa", 1e4, 2e6, "absolute; steps: from each time on; waypoints: smooth between the times"},
      p.pressures_Pa...);
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
