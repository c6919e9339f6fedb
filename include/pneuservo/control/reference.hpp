// References: what the axis shall do, as a position with analytic derivatives up to the seventh.
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace pneuservo {

/// Position and its derivatives: d[0] = x [m], d[i] = d^i x / dt^i [m/s^i].
struct ReferencePoint {
  std::array<double, 8> d{};
};

enum class ReferenceKind { sine, multisine, waypoints, sum, cruise, minimum_jerk, file };

/// A reference as a config states it (docs/config-keys.md); keys that a kind does not have stay unused.
struct ReferenceSpec {
  ReferenceKind kind = ReferenceKind::sine;
  double amplitude_m = 0.0, frequency_Hz = 0.0;                      // sine
  std::vector<std::array<double, 3>> components;                     // multisine: amplitude, frequency, phase
  double center_m = 0.0, start_s = 0.0;
  double ramp_s = -1.0;                                              // < 0: one period (of the slowest component)
  int smoothness = 5;                                                // polynomial degree of ramp or move
  std::vector<double> times_s, positions_m;                          // waypoints
  std::vector<ReferenceSpec> parts;                                  // sum
  double start_m = 0.0, end_m = 0.0, speed_mps = 0.0, duration_s = 0.0;  // cruise, minimum_jerk
  std::string path;                                                  // file
};

}  // namespace pneuservo
