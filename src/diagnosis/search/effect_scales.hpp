// What sizes of effects are measured in, as numbers of a rig and its recordings.
#pragma once
#include <string>

#include <pneuservo/rig/rig.hpp>

#include "elements/effect_entry.hpp"

namespace pneuservo {

/// How far the recordings reach; what sizes are measured in.
struct MotionRange {
  double lowest_m = 0, highest_m = 0, top_speed_mps = 0;
  double duration_s = 0;
  double first_Pa = 0;  ///< highest pressure at which the recording of a vessel begins; 0: not known
};

/// Numbers behind the scales of the vocabulary.
struct ScaleTable {
  const Rig& rig;
  const MotionRange& range;
  std::string channel{};  ///< of a sensor effect
  int side = 1;           ///< of an effect that each side has

  double operator()(EffectScale scale) const;

 private:
  double supply_Pa() const;
  double gauge_supply_Pa() const;
  double force_N() const;
  double valve_area_m2() const;
  double open_flow_kgps() const;  ///< sonic, through the open valve
  double adiabatic_change_K() const;
  double supply_resistance_Pa_s_per_kg() const;
  const LineParameters<double>& line() const { return side == 2 ? rig.axis.line_2 : rig.axis.line_1; }
  double half_stroke_m() const { return 0.5 * rig.axis.cylinder.stroke_m; }
  double top_speed_mps() const;
  double channel_offset() const;
};

}  // namespace pneuservo
