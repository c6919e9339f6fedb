// Numbers that a logger writes where it has no value: -9999, 32767, 1e30.
#pragma once
#include <string>
#include <vector>

#include "record/table.hpp"

namespace pneuservo {

/// Numbers that stand for no value become none, and that is told. Such a number stands there more than once exactly
/// alike, which the noise of the other values rules out; it is entered and left by steps ten times as large as any
/// other; no other channel steps with it; and no physics comes there: it is ten times what any channel usually has, or
/// stands in few single rows. Sensors show by themselves which numbers are such; of a command only those are taken that
/// a sensor has too, or that its other values stay far below. ours: columns of the recording format; theirs: the same
/// in the file.
void leave_out_marks(CsvTable& table, const std::vector<std::string>& ours, const std::vector<std::string>& theirs,
                     std::vector<std::vector<double>>& values);

}  // namespace pneuservo
