// What the channels of a rig can physically read: one place for the loop's guards, commissioning and doubts of
// recordings.
#pragma once
#include <algorithm>
#include <cmath>

#include <pneuservo/elements/air.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Outside lies no measurement. Values in the channel's unit.
struct PossibleRange {
  double lowest = -infinite, highest = infinite;
};

/// Noise and quantum make this much of a step: six standard deviations are exceeded by chance once in 5e8 samples.
inline double sensor_slack(double noise, double quantum) { return 6.0 * noise + quantum; }

/// Equal samples in a row after which a sensor of this noise (rms) and quantum is frozen: by chance once in 1e12 where
/// the value rests in the middle of a quantum, the worst place. 0: so coarse a quantum hides the noise.
inline int frozen_after_ticks(double noise, double quantum) {
  constexpr int fewest = 20, most = 1000;
  if (!(noise > 0.0)) return 0;
  const double repeats = std::erf(quantum / (2.0 * std::sqrt(2.0) * noise));
  if (!(repeats > 0.0)) return fewest;
  if (!(repeats < 1.0)) return 0;  // the noise never leaves the quantum
  const double ticks = std::log(1e-12) / std::log(repeats);
  return ticks <= most ? std::max(fewest, static_cast<int>(std::ceil(ticks))) : 0;
}

/// Limit of pressures that no config states: a stop at the end of the stroke compresses above the supply.
inline double usual_pressure_limit_Pa(const Rig& rig) { return 1.4 * rig.axis.supply.pressure_Pa; }
/// Above it in a chamber, or in the volume of a pressure rig, the loop stops.
inline double chamber_pressure_limit_Pa(const Rig& rig) {
  return rig.limits.pressure_Pa.value_or(usual_pressure_limit_Pa(rig));
}
/// Above it at a port the loop stops. A hose is filled from the supply however little its volume may have.
inline double port_pressure_limit_Pa(const Rig& rig) {
  return rig.controls_pressure() ? usual_pressure_limit_Pa(rig) : chamber_pressure_limit_Pa(rig);
}

/// A chamber that is drawn out falls below the atmosphere, never near a vacuum; above the limit a fault must show.
inline PossibleRange possible_pressure_Pa(const Rig& rig) {
  return {0.3 * rig.axis.air.atmosphere_Pa,
          std::max(1.5 * rig.axis.supply.pressure_Pa, 1.1 * port_pressure_limit_Pa(rig))};
}

/// What lines and chambers do from one sample to the next with a calm valve stays below.
inline double pressure_step_Pa(const Rig& rig) { return 0.05 * rig.axis.supply.pressure_Pa; }

/// Choked flow from the supply into a line, per volt of command.
inline double largest_flow_kgps_per_V(const Rig& rig) {
  const Air<double> air(rig.axis.air);
  return air.flow_constant * rig.axis.supply.pressure_Pa / std::sqrt(air.R * air.temperature_K) *
         rig.axis.valve.area_per_volt_m2_per_V;
}

/// A change of flow dG sends a wave of c dG / A into a line: what a volt does to the pressure at its port at once, in
/// the narrower line.
inline double port_step_Pa_per_V(const Rig& rig) {
  const double section_m2 = std::min(rig.axis.line_1.section_m2(), rig.axis.line_2.section_m2());
  return Air<double>(rig.axis.air).sound_speed() * largest_flow_kgps_per_V(rig) / section_m2;
}

/// Twice the half stroke: beyond that the encoder is not of this axis.
inline PossibleRange possible_position_m(const Rig& rig) {
  const double stroke_m = rig.axis.cylinder.stroke_m;
  return stroke_m > 0 ? PossibleRange{-stroke_m, stroke_m} : PossibleRange{};
}

/// Full supply on the larger piston area with nothing on the other side, or the full drive; three times that is beyond
/// any payload's error. 0: not known.
inline double most_acceleration_mps2(const Rig& rig) {
  const auto& cylinder = rig.axis.cylinder;
  const double mass_kg = rig.axis.slider.mass_kg + rig.axis.slider.payload_kg;
  const double force_N = rig.kind == RigKind::driven_axis
                             ? rig.drive.force_max_N
                             : rig.axis.supply.pressure_Pa * std::max(cylinder.area_1_m2, cylinder.area_2_m2);
  return mass_kg > 0 ? 3.0 * force_N / mass_kg : 0.0;
}

}  // namespace pneuservo
