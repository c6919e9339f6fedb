// Rows as CSV lines, with the columns that a run has.
#pragma once
#include <array>
#include <string>
#include <vector>

#include <pneuservo/record/row.hpp>

namespace pneuservo {

/// Names of all columns of Row, in file order.
const std::vector<std::string>& row_columns();

/// Turns rows into lines; only the chosen columns, in file order whatever the order of the choice.
class RowText {
 public:
  static constexpr std::size_t line_size_max = row_column_count * 32;

  /// Empty = all columns; `t_s` is always there. Throws InputError on a name that Row does not have.
  explicit RowText(const std::vector<std::string>& columns);

  /// Column names, LF at the end.
  std::string header_line() const;
  /// Writes the row's line, LF at the end, to `text` (line_size_max long); returns the end.
  char* line(char* text, const Row& row) const noexcept;

 private:
  std::array<bool, row_column_count> chosen_{};
};

}  // namespace pneuservo
