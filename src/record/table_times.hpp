// Times that stand in more than one column of a table.
#pragma once
#include "record/table.hpp"

namespace pneuservo {

/// Pairs of times and values become one table: a row for every time, with the values that stand at it.
void join_times(CsvTable& table);

/// Milliseconds in a column of their own are added to times of day that are whole seconds.
void add_milliseconds(CsvTable& table);

}  // namespace pneuservo
