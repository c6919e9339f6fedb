// Rows that repeat a sample, as a logger writes them that is faster than what it reads.
#pragma once
#include "record/reader.hpp"

namespace pneuservo {

/// Where all columns, the commands too, change in every n-th row alone, the others are left out. Where a sensor does,
/// or in gaps of two and three rows, its repeats become no value. Both are told. Most of the n-th rows must change, as
/// a clock makes it, and the steps must be of many sizes: those of a slow quantised channel are one quantum or two, and
/// those of a cycle its whole stroke. A command that is held stays so.
void leave_out_repeats(Recording& run);

}  // namespace pneuservo
