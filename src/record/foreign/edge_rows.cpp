// Lines above and below the rows of a table that look like rows and are none.
#include "record/foreign/edge_rows.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "config/input_error.hpp"

#include "record/column_values.hpp"
#include "record/foreign/units.hpp"

namespace pneuservo {

namespace {

constexpr std::size_t most_edge_rows = 3;  ///< more are rows of another stretch
constexpr std::size_t most_kept = 1000;

/// Powers of ten in each column, not all 1: they may be factors.
bool may_be_factors(const CsvTable& table, std::size_t row) {
  bool are_ones = true;
  for (const std::vector<double>& values : table.values) {
    if (!is_power_of_ten(values[row])) return false;
    are_ones = are_ones && values[row] == 1;
  }
  return !are_ones;
}

/// Whether a row goes on from its neighbour as the rows do in some column: in even steps, as times and counters are.
bool continues_rows(const CsvTable& table, std::size_t row, std::size_t neighbour) {
  constexpr std::size_t most_seen = 200;
  constexpr double alike = 0.1, nearly_all = 0.9, next = 0.5;
  const double way = row < neighbour ? -1 : 1;
  for (const std::vector<double>& values : table.values) {
    std::vector<double> steps;
    const std::size_t begin = row < neighbour ? neighbour : neighbour - std::min(neighbour, most_seen);
    const std::size_t end = std::min(begin + most_seen, row < neighbour ? values.size() : neighbour + 1);
    for (std::size_t i = begin + 1; i < end; ++i) steps.push_back(values[i] - values[i - 1]);
    if (steps.empty()) continue;
    const double usual = median_of(steps);
    const auto even = std::count_if(steps.begin(), steps.end(),
                                    [&](double step) { return std::abs(step - usual) < alike * std::abs(usual); });
    if (static_cast<double>(even) < nearly_all * static_cast<double>(steps.size())) continue;
    if (std::abs(values[row] - values[neighbour] - way * usual) < next * std::abs(usual)) return true;
  }
  return false;
}

template <class Values>
void cut_ends(Values& values, std::size_t front, std::size_t back) {
  values.erase(values.end() - static_cast<std::ptrdiff_t>(back), values.end());
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(front));
}

}  // namespace

void EdgeRows::add(std::size_t row) {
  if (rows_.size() < most_kept) rows_.push_back(row);
}

std::size_t EdgeRows::leave_out(CsvTable& table) const {
  const std::size_t rows = table.rows();
  std::size_t front = 0, back = 0;
  while (front < rows_.size() && rows_[front] == front) ++front;
  while (front + back < rows_.size() && rows_[rows_.size() - 1 - back] == rows - 1 - back) ++back;
  if (front > most_edge_rows) front = 0;
  if (back > most_edge_rows) back = 0;
  for (std::size_t row = front; row-- > 0 && continues_rows(table, row, row + 1);) front = row;
  for (; back > 0 && continues_rows(table, rows - back, rows - back - 1);) --back;
  const auto tell = [&](std::size_t row, std::string_view place) {
    table.report(
        table.line_numbers[row], ProblemKind::dialect,
        fmt::format("the numbers have other decimals than those of the rows: a line {} the rows, not used", place));
  };
  for (std::size_t i = 0; i < front; ++i) {
    if (may_be_factors(table, i)) refuse_factors(table.path, table.line_numbers[i]);
    tell(i, "above");
  }
  for (std::size_t i = rows - back; i < rows; ++i) tell(i, "below");
  for (std::vector<double>& values : table.values) cut_ends(values, front, back);
  cut_ends(table.line_numbers, front, back);
  return front;
}

void refuse_factors(const std::string& path, std::size_t line) {
  throw InputError(
      fmt::format("{}, line {}: found factors or offsets of the columns, and nothing says whether the rows below hold "
                  "the values before or behind them; expected values in the stated units: take this line out where "
                  "they are, else scale them",
                  path, line));
}

}  // namespace pneuservo
