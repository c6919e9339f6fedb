// Times that stand in more than one column of a table.
#pragma once
#include "record/table.hpp"

namespace pneuservo {

/// Pairs of times and values become one table: a row for every time, with the values that stand at it.
void join_times(CsvTable& table);

/// Milli-, micro- or nanoseconds in a column of their own are added to times that are whole seconds.
void add_fractions(CsvTable& table);

/// Where no column holds times, but the head states an interval or a rate, rows are counted in a column t_s.
/// decimal: of the rows.
void count_rows(CsvTable& table, char decimal);

}  // namespace pneuservo
