// One spool opens both sides: what that says of pressures, the position's zero and the command.
#pragma once
#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// Whether one opening of the valve explains the gas of both sides at each instant, one filled and the other emptied.
/// Root mean square of what is left beside leaks to the atmosphere, past the piston and past the edges from the supply,
/// as a share of the gas, and the mean difference between the ends of each line as a share of the atmosphere; infinite
/// where a side is not measured. At most judged_s are taken. The command has no part in it, nor has what the valve
/// does with it. In motion emptying is choked and filling is not, so that an error of all pressures shows.
double sides_misfit(const Rig& rig, const Recording& recording);

/// The same, ends of lines too, with the opening that the command asks for beside a dead band: at most 1.
double gas_misfit(const Rig& rig, const Recording& recording);

/// Geometric mean of both: what either tells of a reading counts.
double opening_misfit(const Rig& rig, const Recording& recording);

}  // namespace pneuservo
