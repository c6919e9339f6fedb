// A time whose hours, minutes, seconds and fractions stand in columns, or digits, of their own.
#pragma once
#include "record/table.hpp"

namespace pneuservo {

/// Columns such as Hour, Minute, Second and Millisecond side by side, also behind year, month and day, and hh:mm beside
/// seconds, become one column of times.
void join_time_parts(CsvTable& table);

/// Numbers of a column of times that read as hhmmss.sss, and go on so where each minute ends, become seconds.
void read_digits_of_day(CsvTable& table);

}  // namespace pneuservo
