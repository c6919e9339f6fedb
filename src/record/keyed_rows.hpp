// Rows whose fields bear their names: "t:0.001,x:0.5" or "t=0.001 x=0.5", as serial plotters want them.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace pneuservo {

struct KeyedRows {
  char separator = ',';
  char sign = ':';  ///< between name and value
  std::vector<std::string> names;

  /// The names as a line of a table.
  std::string names_line() const;
  /// The row without its names; a field under another name than its place's is left as it is.
  std::string row(std::string_view line) const;
};

/// No names where the lines are no such rows.
KeyedRows find_keyed_rows(const std::vector<std::string>& lines);

}  // namespace pneuservo
