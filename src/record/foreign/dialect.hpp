// How a foreign table is written, found from its first lines.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "record/foreign/field_text.hpp"

namespace pneuservo {

struct Dialect {
  FieldStyle style;
  std::vector<std::string> names;
  std::vector<std::string> units;        ///< of the row below the names or behind the values; empty: none
  std::vector<std::string> value_units;  ///< what stands behind each value of a column, to be taken off
  bool has_units_row = false;
  bool has_names_below = false;  ///< names go on over two lines
  bool has_rows_between = false;  ///< of units, types or labels between the names and the first row: no data
  std::size_t first_row = 1;      ///< index of the first line of numbers in the sample
  std::size_t names_line = 0;     ///< index of the line of names
  bool has_index = false;         ///< the first field of each row counts the rows, and is left out
  bool has_trailing = false;      ///< a separator ends each row
  bool is_quoted = false;
  bool has_pairs = false;         ///< each value has a column of times before it
  bool has_split_times = false;   ///< the second field holds the decimals of the time in the first
  std::size_t least_fields = 0;   ///< of rows that leave out what is empty at their end; 0: all rows are whole
  double factor = 1;     ///< of all values, where the head states one
  std::vector<int> decimals;  ///< digits behind the decimal sign that nearly all rows have in a field; -1: any
  std::optional<std::size_t> scale_line;  ///< index of a line that states factors or offsets of the columns
  char names_separator = 0;  ///< where it is not the rows'
  bool is_sure = false;  ///< most lines were rows, and a decimal sign was among them: more lines say no more
  bool is_nameless = false;  ///< the first line is a row of numbers already

  /// In words, what is not as in the format of this program: "separator ;, decimal comma". Empty: nothing.
  std::string words() const;
};

/// The dialect in which most fields of the lines are numbers. `lines`: the first ones after the comments, at least one;
/// without a row of numbers among them the first line holds the names, separated by commas.
Dialect find_dialect(const std::vector<std::string>& lines);

}  // namespace pneuservo
