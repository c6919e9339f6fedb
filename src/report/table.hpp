// A table of words and figures, printed on the screen and on a page alike.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace pneuservo {

/// One column: its title, the unit of all its cells (may be empty) and the cells, one a row.
struct TableColumn {
  std::string title, unit;
  std::vector<std::string> cells;
  bool is_text = false;  ///< words, aligned to the left; figures are aligned to the right
};

struct Table {
  std::string title;
  std::vector<TableColumn> columns;
  int best_row = -1;     ///< row that a page sets off; -1: none
};

/// A column of words.
TableColumn text_column(std::string title, std::vector<std::string> cells);

/// A column of figures with one number of decimals for all of them: four significant digits for the largest and two for
/// the smallest where `decimals_max` allows. A value that is not finite is an en dash.
TableColumn figure_column(std::string title, std::string unit, const std::vector<double>& values, int decimals_max = 4);

/// A column of counts.
TableColumn count_column(std::string title, const std::vector<std::int64_t>& values);

/// The table in aligned lines for a terminal: titles, units, cells; ends with a newline.
std::string text_table(const Table& table);

/// A figure in words' company: three significant digits, no exponent between 1e-3 and 1e6; an en dash if not finite.
std::string figure(double value);

}  // namespace pneuservo
