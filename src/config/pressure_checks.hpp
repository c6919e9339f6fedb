// What the keys of a pressure rig leave open, and what no single one of them can say.
#pragma once
#include <pneuservo/rig/rig.hpp>

#include "config/check.hpp"

namespace pneuservo {

/// Start, duration and the layout on an axis, as far as the config does not state them.
void complete_pressure_rig(Rig& rig, const ConfigNode& root);
/// Hose, start and reference against supply, atmosphere and limits.
void check_pressure_numbers(const Rig& rig, const Check& check);

}  // namespace pneuservo
