// Whether a recording's channels can belong together at all: balances of gas and force at each instant.
#pragma once
#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// Of the top speed: slower motion may stick, and tells no direction. 0.03 to 0.3 gave the same answers on 120
/// recordings of 12 simulated machines; the position's noise as the limit missed most exchanged ports.
inline constexpr double slow_share = 0.1;

/// Root mean square over the balances below of what each leaves, as a share of its own swing: 0 all explained, 1
/// nothing; infinite where the recording cannot be prepared. At most judged_s are taken. Nothing is integrated in time,
/// so a dead band, a leak or a rest does not make it drift.
/// Each side: the rate of the gas in chamber and line against the flow through the valve. A factor of at least 0 and a
/// constant are free, for the valve's gain and leaks.
/// The force of the ports, and that of the chambers where they are measured: against mass times acceleration and a
/// friction of at least 0. A constant is free, for weight and offsets.
double balance_misfit(const Rig& rig, const Recording& recording);

}  // namespace pneuservo
