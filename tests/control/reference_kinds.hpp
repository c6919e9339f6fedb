// One reference of every kind, for tests that hold for all of them.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include <pneuservo/control/reference.hpp>

namespace pneuservo::test {

inline std::pair<std::vector<double>, std::vector<double>> load_samples(const std::string&) {
  std::pair<std::vector<double>, std::vector<double>> samples;
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.3 + 0.01 * i + (i % 3 == 1 ? 0.002 : 0.0);
    samples.first.push_back(t);
    samples.second.push_back(0.05 * std::sin(3.0 * (t - 0.3)) + 0.01 * std::cos(9.0 * t));
  }
  return samples;
}

struct NamedReference {
  std::string name;
  ReferenceSpec spec;
  int continuous;  ///< derivatives up to this one have no jump anywhere
};

inline ReferenceSpec sine_spec(double amplitude_m, double frequency_Hz, int smoothness = 5) {
  ReferenceSpec s;
  s.kind = ReferenceKind::sine;
  s.amplitude_m = amplitude_m;
  s.frequency_Hz = frequency_Hz;
  s.smoothness = smoothness;
  return s;
}

inline std::vector<NamedReference> all_references() {
  std::vector<NamedReference> out;
  for (const int degree : {3, 5, 7, 9, 11}) {
    const int k = (degree - 1) / 2;
    const std::string suffix = " of degree " + std::to_string(degree);
    ReferenceSpec sine = sine_spec(0.08, 1.3, degree);
    sine.center_m = 0.01;
    sine.start_s = 0.25;
    out.push_back({"sine" + suffix, sine, k + 1});  // sin is 0 at both ends of a ramp of one period: one order more

    ReferenceSpec multisine;
    multisine.kind = ReferenceKind::multisine;
    multisine.components = {{0.03, 0.7, 0.4}, {0.02, 1.9, -1.0}, {0.005, 4.0, 2.0}};
    multisine.smoothness = degree;
    multisine.ramp_s = 0.9;
    multisine.start_s = 0.1;
    out.push_back({"multisine" + suffix, multisine, k});

    ReferenceSpec way;
    way.kind = ReferenceKind::waypoints;
    way.times_s = {0.2, 0.7, 1.0, 1.9};
    way.positions_m = {-0.02, 0.06, 0.06, -0.05};
    way.smoothness = degree;
    out.push_back({"waypoints" + suffix, way, k});

    ReferenceSpec cruise;
    cruise.kind = ReferenceKind::cruise;
    cruise.start_m = degree == 5 ? 0.05 : -0.05;
    cruise.end_m = degree == 5 ? -0.05 : 0.05;
    cruise.speed_mps = 0.0597;
    cruise.ramp_s = 0.156;
    cruise.start_s = 0.2;
    cruise.smoothness = degree;
    out.push_back({"cruise" + suffix, cruise, k + 1});
  }
  ReferenceSpec move;
  move.kind = ReferenceKind::minimum_jerk;
  move.start_m = -0.06;
  move.end_m = 0.06;
  move.duration_s = 0.8;
  move.start_s = 0.3;
  out.push_back({"minimum_jerk", move, 2});

  ReferenceSpec file;
  file.kind = ReferenceKind::file;
  file.path = "samples";
  out.push_back({"file", file, 3});

  ReferenceSpec sum;
  sum.kind = ReferenceKind::sum;
  sum.parts = {move, sine_spec(0.01, 2.0, 11)};
  out.push_back({"sum", sum, 2});
  return out;
}

}  // namespace pneuservo::test
