// Rows as CSV lines, with the columns that a run has.
#pragma once
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/record/row.hpp>

namespace pneuservo {

/// Names of all columns of Row, in file order; `terms` names those of the law.
std::vector<std::string> row_columns(std::span<const std::string_view> terms = {});

/// Names of all columns of the format but the terms of a law: those of Row and the drive force.
std::vector<std::string> columns_of_the_format();

/// Turns rows into lines; only the chosen columns, in file order whatever the order of the choice.
class RowText {
 public:
  static constexpr std::size_t column_max = row_column_count + Row::most_terms;
  static constexpr std::size_t line_size_max = column_max * 32;

  /// Empty = all columns; `t_s` is always there. Throws InputError on a name that Row does not have.
  explicit RowText(const std::vector<std::string>& columns, std::span<const std::string_view> terms = {});

  /// Column names, LF at the end.
  std::string header_line() const;
  /// Writes the row's line, LF at the end, to `text` (line_size_max long); returns the end.
  char* line(char* text, const Row& row) const noexcept;

 private:
  std::vector<std::string> names_;
  std::span<const std::string_view> terms_;
  std::array<bool, column_max> chosen_{};
};

}  // namespace pneuservo
