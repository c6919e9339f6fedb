// Lines above and below the rows of a table that look like rows and are none.
#include "record/edge_rows.hpp"

#include <cmath>

#include <fmt/format.h>

#include "config/input_error.hpp"

namespace pneuservo {

namespace {

constexpr std::size_t most_edge_rows = 3;  ///< more are rows of another stretch
constexpr std::size_t most_kept = 1000;

/// Powers of ten in each column, not all 1: they may be factors.
bool may_be_factors(const CsvTable& table, std::size_t row) {
  constexpr double tolerance = 1e-9;
  bool are_ones = true;
  for (const std::vector<double>& values : table.values) {
    const double power = std::log10(values[row]);
    if (!std::isfinite(power) || std::abs(power - std::round(power)) > tolerance) return false;
    are_ones = are_ones && power == 0;
  }
  return !are_ones;
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
