// Rows whose values bear their names: "t:0.001,x:0.5" or "t=0.001 x=0.5", as serial plotters want them; lines of a log
// such as "2026-01-03 10:11:12.001 INFO [axis] x=0.5 u=1", of JSON and of a database's line protocol.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace pneuservo {

struct KeyedRows {
  char separator = ',';
  char sign = ':';  ///< between name and value
  bool is_scanned = false;  ///< values are sought in the text by their names
  std::vector<std::string> names;

  /// The names as a line of a table.
  std::string names_line() const;
  /// The row without its names; a field under another name than its place's is left as it is, a line without any of
  /// the names that are sought too.
  std::string row(std::string_view line) const;
  /// False of a line between rows that has no value with a name.
  bool holds_values(std::string_view line) const;
};

/// No names where the lines are no such rows.
KeyedRows find_keyed_rows(const std::vector<std::string>& lines);

}  // namespace pneuservo
