// References that a rig can follow without harm: the menu of the next experiment.
#include "diagnosis/verdict/safe_references.hpp"

#include <algorithm>
#include <cmath>

namespace pneuservo {
namespace {

constexpr double duration_s = 8.0, begin_s = 0.4;
constexpr double least_supply_Pa = 250e3;  ///< absolute: below it valve and cylinder are at the end of their range
constexpr double force_share = 0.3;      ///< of the drive, for acceleration
constexpr double peak_of_move = 1.875;   ///< speed of a minimum-jerk move over its mean
constexpr double jerk_of_move = 5.7735;  ///< its acceleration over way / duration^2
constexpr double two_pi = 6.283185307179586;

/// What the references are cut to.
struct Reach {
  double half_stroke_m, speed_mps, acceleration_mps2;
};

Reach reach_of(const Rig& rig, double shown_speed_mps) {
  const auto& axis = rig.axis;
  const double gauge = std::max(axis.supply.pressure_Pa - axis.air.atmosphere_Pa, 0.0);
  const double force =
      rig.is_pneumatic() ? gauge * std::min(axis.cylinder.area_1_m2, axis.cylinder.area_2_m2) : rig.drive.force_max_N;
  return {0.5 * axis.cylinder.stroke_m, std::max(shown_speed_mps, 1e-3),
          force_share * force / (axis.slider.mass_kg + axis.slider.payload_kg)};
}

ReferenceSpec sine(const Reach& reach, double amplitude_share, double speed_share) {
  ReferenceSpec spec;
  spec.kind = ReferenceKind::sine;
  spec.amplitude_m = amplitude_share * reach.half_stroke_m;
  const double rate =
      std::min(speed_share * reach.speed_mps / spec.amplitude_m, std::sqrt(reach.acceleration_mps2 / spec.amplitude_m));
  spec.frequency_Hz = std::clamp(rate / two_pi, 0.05, 8.0);
  spec.start_s = begin_s;
  return spec;
}

/// A fundamental and its double: slow one way, fast the other.
ReferenceSpec asymmetric_sine(const Reach& reach) {
  ReferenceSpec spec = sine(reach, 0.4, 0.6);
  spec.kind = ReferenceKind::multisine;
  spec.components = {{spec.amplitude_m, spec.frequency_Hz, 0.0}, {0.5 * spec.amplitude_m, 2 * spec.frequency_Hz, 1.57}};
  return spec;
}

/// Moves from place to place (shares of half the stroke) with rests between them, until the time is over.
ReferenceSpec moves(const Reach& reach, const std::vector<double>& places, double speed_share, double rest_s) {
  ReferenceSpec spec;
  spec.kind = ReferenceKind::waypoints;
  spec.times_s = {0.0, begin_s};
  spec.positions_m = {0.0, 0.0};
  double time = begin_s, place = 0.0;
  for (std::size_t i = 0; time < duration_s; i = (i + 1) % places.size()) {
    const double next = places[i] * reach.half_stroke_m, way = std::abs(next - place);
    time += std::max({peak_of_move * way / (speed_share * reach.speed_mps),
                      std::sqrt(jerk_of_move * way / reach.acceleration_mps2), 0.05});
    spec.times_s.push_back(time);
    spec.positions_m.push_back(next);
    spec.times_s.push_back(time += rest_s);
    spec.positions_m.push_back(next);
    place = next;
  }
  return spec;
}

}  // namespace

std::vector<ExperimentChoice> safe_references(const Rig& rig, double shown_speed_mps) {
  const Reach reach = reach_of(rig, shown_speed_mps);
  const ReferenceSpec fast_moves = moves(reach, {0.6, -0.6}, 1.5, 0.4);
  const ReferenceSpec full_stroke = moves(reach, {0.85, -0.85}, 1.0, 0.6);
  std::vector<ReferenceSpec> plain{sine(reach, 0.5, 0.3),                             // slow
                                   sine(reach, 0.15, 1.5),                            // fast
                                   sine(reach, 0.85, 1.0),                            // along the whole stroke
                                   asymmetric_sine(reach),
                                   moves(reach, {0.2, 0.0, -0.2, 0.0}, 1.0, 1.0),     // steps with rests
                                   moves(reach, {0.6, -0.6}, 0.6, 2.2),               // long rests at two places
                                   moves(reach, {0.1, -0.1}, 0.08, 0.3),              // creep
                                   sine(reach, 0.02, 0.2),                            // dither around rest
                                   sine(reach, 0.01, 0.5),                            // quicker
                                   fast_moves,
                                   full_stroke};
  std::vector<ExperimentChoice> menu;
  menu.reserve(plain.size() + 3);
  for (const ReferenceSpec& reference : plain) menu.push_back({reference, duration_s, "", {}});
  const auto lower_supply = [&](double share, const char* words) {
    const double supply_Pa = share * rig.axis.supply.pressure_Pa;
    if (rig.is_pneumatic() && supply_Pa > least_supply_Pa)
      menu.push_back({fast_moves, duration_s, words, {{"supply.pressure_Pa", supply_Pa}}});
  };
  lower_supply(0.75, "set the supply to three quarters of its pressure");
  lower_supply(0.5, "set the supply to half its pressure");
  const double payload_kg = rig.axis.slider.payload_kg + 0.5 * rig.axis.slider.mass_kg;
  menu.push_back({fast_moves,
                  duration_s,
                  "add a payload of known mass, half that of the slider",
                  {{"slider.payload_kg", payload_kg}}});
  return menu;
}

}  // namespace pneuservo
