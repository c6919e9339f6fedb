// Tables of words and figures.
#include <report/table.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuservo {
namespace {

constexpr const char* no_figure = "–";

/// Digits before the decimal point, negative for leading zeros behind it: 2 for 12.3, 1 for 1.2, 0 for 0.12.
int magnitude(double value) { return static_cast<int>(std::floor(std::log10(value))) + 1; }

int decimals_of(const std::vector<double>& values, int decimals_max) {
  double largest = 0.0, smallest = 0.0;
  for (double value : values) {
    const double size = std::fabs(value);
    if (!std::isfinite(value) || size == 0.0) continue;
    largest = std::max(largest, size);
    smallest = smallest == 0.0 ? size : std::min(smallest, size);
  }
  if (largest == 0.0) return 0;
  const int wanted = std::max(4 - magnitude(largest), 2 - magnitude(smallest));
  return std::clamp(wanted, 0, decimals_max);
}

/// Characters on the screen: bytes of UTF-8 that start one.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string aligned(const std::string& text, std::size_t width, bool to_left) {
  const std::string space(width - std::min(width, width_of(text)), ' ');
  return to_left ? fmt::format("{}{}", text, space) : fmt::format("{}{}", space, text);
}

}  // namespace

TableColumn text_column(std::string title, std::vector<std::string> cells) {
  return {std::move(title), "", std::move(cells), true};
}

TableColumn figure_column(std::string title, std::string unit, const std::vector<double>& values, int decimals_max) {
  TableColumn column{std::move(title), std::move(unit), {}, false};
  const int decimals = decimals_of(values, decimals_max);
  for (double value : values)
    column.cells.push_back(std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : no_figure);
  return column;
}

TableColumn count_column(std::string title, const std::vector<std::int64_t>& values) {
  TableColumn column{std::move(title), "", {}, false};
  for (std::int64_t value : values) column.cells.push_back(fmt::format("{}", value));
  return column;
}

std::string text_table(const Table& table) {
  std::size_t rows = 0;
  std::vector<std::size_t> widths;
  for (const TableColumn& column : table.columns) {
    std::size_t width = std::max(width_of(column.title), column.unit.empty() ? 0 : width_of(column.unit) + 2);
    for (const std::string& cell : column.cells) width = std::max(width, width_of(cell));
    widths.push_back(width);
    rows = std::max(rows, column.cells.size());
  }
  const auto line = [&](auto&& text_of) {
    std::vector<std::string> cells;
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      cells.push_back(aligned(text_of(table.columns[i]), widths[i], table.columns[i].is_text));
    std::string joined = fmt::format("{}", fmt::join(cells, "  "));
    joined.erase(joined.find_last_not_of(' ') + 1);
    return joined + "\n";
  };
  std::string text = table.title.empty() ? "" : table.title + "\n";
  text += line([](const TableColumn& column) { return column.title; });
  const bool units = std::any_of(table.columns.begin(), table.columns.end(), [](auto& c) { return !c.unit.empty(); });
  if (units)
    text += line([](const TableColumn& column) {
      return column.unit.empty() ? std::string() : fmt::format("[{}]", column.unit);
    });
  for (std::size_t row = 0; row < rows; ++row)
    text +=
        line([&](const TableColumn& column) { return row < column.cells.size() ? column.cells[row] : std::string(); });
  return text;
}

std::string figure(double value) {
  if (!std::isfinite(value)) return no_figure;
  const double size = std::fabs(value);
  if (size == 0.0) return "0";
  if (size < 1e-3 || size >= 1e6) return fmt::format("{:.2e}", value);
  return fmt::format("{:.{}f}", value, std::clamp(3 - magnitude(size), 0, 6));
}

}  // namespace pneuservo
