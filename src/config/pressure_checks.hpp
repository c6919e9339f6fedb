// What the keys of a pressure rig leave open, and what no single one of them can say.
#pragma once
#include <pneuservo/rig/rig.hpp>

#include "config/check.hpp"

namespace pneuservo {

/// Start, duration and the layout on an axis, as far as the config does not state them.
void complete_pressure_rig(Rig& rig, const ConfigNode& root);
/// Rates of the pressure p in the volume of the rig with its valve open, without the hose's drop.
double valve_fills_Pa_per_s(const Rig& rig, double p_Pa);
double valve_empties_Pa_per_s(const Rig& rig, double p_Pa);
/// Hose, start and reference against supply, atmosphere and limits.
void check_pressure_numbers(const Rig& rig, const Check& check);

}  // namespace pneuservo
