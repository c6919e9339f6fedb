// Times that stand in more than one column of a table.
#pragma once
#include "record/foreign/field_text.hpp"
#include "record/table.hpp"

namespace pneuservo {

/// Columns whose times stand before them, each or some together, become one table with one column of times.
/// has_pairs: every second column is known to be that of the times.
void join_times(CsvTable& table, bool has_pairs);

/// Fractions, milli-, micro- or nanoseconds in a column of their own are added to times that are whole seconds; so are
/// hours, minutes and seconds (record/time_parts.hpp).
void add_fractions(CsvTable& table);

/// So many rows before one of the table are not in it.
struct MissingRows {
  std::size_t before = 0;
  long long count = 0;
};

/// Where no column holds times, but the head states an interval or a rate, rows are counted in a column t_s, the
/// missing ones too; those of columns at rates or from starts of their own are brought to one table. Throws InputError
/// where the head states rates that differ for another number of columns. style: of the rows.
void count_rows(CsvTable& table, const FieldStyle& style, const std::vector<MissingRows>& missing);

}  // namespace pneuservo
