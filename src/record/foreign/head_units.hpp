// Units that lines of a head state in words: "x in mm, p1 and p2 in bar", "Position: mm", "units: s, mm, V".
#pragma once
#include "record/table.hpp"

namespace pneuservo {

/// Columns without a unit get the one that a line of the head states for their names, for a quantity ("pressures in
/// bar") or in a list with a unit for each column; it is told. A line that says anything else says no units.
void take_head_units(CsvTable& table);

}  // namespace pneuservo
