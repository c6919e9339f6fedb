// Rows that repeat a sample, as a logger writes them that is faster than what it reads.
#pragma once
#include "record/reader.hpp"

namespace pneuservo {

/// Where all columns, the commands too, change in every n-th row alone, the others are left out. Where a sensor does,
/// or in gaps of n and n + 1 rows, its repeats become no value. Both are told. Chance must rule it out, and the steps
/// must be of several sizes: those of a coarse sensor at an even speed are of one. A command that is held stays so.
void leave_out_repeats(Recording& run);

}  // namespace pneuservo
