// What no single key of a control law can be checked for.
#pragma once
#include <pneuservo/rig/rig.hpp>

#include "config/check.hpp"

namespace pneuservo {

/// The law in use against reference, lines and pressures.
void check_law(const Rig& rig, const Check& check);

}  // namespace pneuservo
