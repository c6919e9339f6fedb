// Rows whose values bear their names: "t:0.001,x:0.5" or "t=0.001 x=0.5", as serial plotters want them; lines of a log
// such as "2026-01-03 10:11:12.001 INFO [axis] x=0.5 u=1", of JSON and of a database's line protocol.
#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "record/foreign/dialect.hpp"
#include "record/foreign/named_values.hpp"
#include "record/table.hpp"

namespace pneuservo {

struct KeyedRows {
  PairStyle style;
  std::vector<std::string> names;  ///< of the columns; none: the lines are no such rows
  std::vector<std::string> units;  ///< behind the values of each column; empty: none, or of several quantities
  std::map<std::string, std::size_t> left_out;  ///< names of no column, with the lines that hold them

  /// The names as a line of a table between commas.
  std::string names_line() const;
  /// The values in the order of the names, empty where the line has none; a line without any of the names as it is.
  std::string row(std::string_view line);
  /// False of a line between rows that has no value with a name.
  bool holds_values(std::string_view line) const;
  /// Puts the units where those of a row below the names would stand.
  void state_units(Dialect& dialect) const;
  /// What was left out.
  void tell(CsvTable& table) const;
};

/// No names where the lines are no such rows.
KeyedRows find_keyed_rows(const std::vector<std::string>& lines);

}  // namespace pneuservo
