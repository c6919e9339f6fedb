// Times that stand in more than one column of a table.
#include "record/table_times.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace pneuservo {

namespace {

bool is_same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

/// Row numbers of all times of the pairs, in order of time.
std::map<double, std::size_t> rows_of_times(const CsvTable& table, std::size_t pairs) {
  std::map<double, std::size_t> rows;
  for (std::size_t p = 0; p < pairs; ++p)
    for (const double time : table.values[2 * p])
      if (std::isfinite(time)) rows.emplace(time, 0);
  std::size_t count = 0;
  for (auto& [time, row] : rows) row = count++;
  return rows;
}

bool is_milliseconds(const std::string& name) {
  constexpr std::array<std::string_view, 6> names{"ms",          "msec",         "millis",
                                                  "millisecond", "milliseconds", "millisekunden"};
  std::string letters;
  for (const char c : name)
    if (std::isalpha(static_cast<unsigned char>(c)))
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(names.begin(), names.end(), letters) != names.end();
}

bool are_whole(const std::vector<double>& values, double least, double most) {
  return std::all_of(values.begin(), values.end(),
                     [&](double v) { return std::isnan(v) || (v == std::round(v) && v >= least && v <= most); });
}

}  // namespace

void join_times(CsvTable& table) {
  const std::size_t pairs = table.values.size() / 2;
  bool all_alike = true;
  for (std::size_t p = 1; p < pairs; ++p) all_alike = all_alike && is_same(table.values[0], table.values[2 * p]);
  if (all_alike) return;
  const std::map<double, std::size_t> rows = rows_of_times(table, pairs);
  std::vector<std::vector<double>> values(1);
  std::vector<std::string> names{table.names[0]}, units{table.units[0]};
  for (const auto& [time, row] : rows) values[0].push_back(time);
  for (std::size_t p = 0; p < pairs; ++p) {
    const std::vector<double>&times = table.values[2 * p], &theirs = table.values[2 * p + 1];
    values.emplace_back(rows.size(), no_value);
    for (std::size_t i = 0; i < times.size(); ++i)
      if (std::isfinite(times[i])) values.back()[rows.at(times[i])] = theirs[i];
    names.push_back(table.names[2 * p + 1]);
    units.push_back(table.units[2 * p + 1]);
  }
  std::vector<char> is_clock(names.size(), 0);
  is_clock[0] = table.is_clock[0];
  table.values = std::move(values);
  table.names = std::move(names);
  table.units = std::move(units);
  table.is_clock = std::move(is_clock);
  table.line_numbers.resize(rows.size(), table.line_numbers.empty() ? 0 : table.line_numbers.back());
  table.report(0, ProblemKind::dialect, "each column has times of its own: brought to one table by them");
}

void add_milliseconds(CsvTable& table) {
  constexpr double most_ms = 999;
  for (std::size_t c = 0; c < table.names.size(); ++c)
    for (std::size_t m = 0; m < table.names.size() && table.is_clock[c] != 0; ++m) {
      const std::vector<double>& milliseconds = table.values[m];
      if (!is_milliseconds(table.names[m]) || !are_whole(milliseconds, 0, most_ms)) continue;
      if (!are_whole(table.values[c], -std::numeric_limits<double>::infinity(),
                     std::numeric_limits<double>::infinity()))
        continue;
      for (std::size_t i = 0; i < milliseconds.size(); ++i) table.values[c][i] += 1e-3 * milliseconds[i];
      table.report(0, ProblemKind::dialect,
                   fmt::format("column {} is taken for the milliseconds of {}", table.names[m], table.names[c]));
    }
}

}  // namespace pneuservo
