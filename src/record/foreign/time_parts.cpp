// A time whose hours, minutes, seconds and fractions stand in columns, or digits, of their own.
#include "record/foreign/time_parts.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "record/column_values.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/foreign/field_text.hpp"
#include "record/reader.hpp"

namespace pneuservo {

namespace {

/// Parts of a time from the largest to the smallest.
enum class TimePart { year, month, day, hour, minute, second, millisecond, none };

TimePart time_part_of(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, TimePart>, 30> words{{{"year", TimePart::year},
                                                                         {"jahr", TimePart::year},
                                                                         {"month", TimePart::month},
                                                                         {"monat", TimePart::month},
                                                                         {"day", TimePart::day},
                                                                         {"tag", TimePart::day},
                                                                         {"hour", TimePart::hour},
                                                                         {"hours", TimePart::hour},
                                                                         {"h", TimePart::hour},
                                                                         {"hh", TimePart::hour},
                                                                         {"hr", TimePart::hour},
                                                                         {"std", TimePart::hour},
                                                                         {"stunde", TimePart::hour},
                                                                         {"minute", TimePart::minute},
                                                                         {"minutes", TimePart::minute},
                                                                         {"min", TimePart::minute},
                                                                         {"mm", TimePart::minute},
                                                                         {"second", TimePart::second},
                                                                         {"seconds", TimePart::second},
                                                                         {"sec", TimePart::second},
                                                                         {"s", TimePart::second},
                                                                         {"ss", TimePart::second},
                                                                         {"sek", TimePart::second},
                                                                         {"sekunde", TimePart::second},
                                                                         {"ms", TimePart::millisecond},
                                                                         {"msec", TimePart::millisecond},
                                                                         {"millis", TimePart::millisecond},
                                                                         {"millisecond", TimePart::millisecond},
                                                                         {"milliseconds", TimePart::millisecond},
                                                                         {"millisekunde", TimePart::millisecond}}};
  const std::string small = in_small_letters(name);
  const auto at = std::find_if(words.begin(), words.end(), [&](const auto& word) { return word.first == small; });
  return at == words.end() ? TimePart::none : at->second;
}

/// Whether all values are those of this part; only seconds and milliseconds have decimals.
bool are_values_of(const std::vector<double>& values, TimePart part) {
  constexpr std::array<std::pair<double, double>, 7> ranges{
      {{1900, 2200}, {1, 12}, {1, 31}, {0, 24}, {0, 59}, {0, 60.999999}, {0, 999.999999}}};
  const auto [least, most] = ranges[static_cast<std::size_t>(part)];
  return std::all_of(values.begin(), values.end(), [&](double value) {
    return std::isnan(value) ||
           (value >= least && value <= most && (part >= TimePart::second || value == std::round(value)));
  });
}

/// Columns from `first` on that hold parts, each smaller than the one before.
std::vector<std::pair<std::size_t, TimePart>> parts_from(const CsvTable& table, std::size_t first) {
  std::vector<std::pair<std::size_t, TimePart>> out;
  for (std::size_t c = first; c < table.names.size(); ++c) {
    const TimePart part = time_part_of(table.names[c]);
    if (part == TimePart::none || table.is_clock[c] != 0 || !are_values_of(table.values[c], part)) break;
    if (!out.empty() && static_cast<int>(part) != static_cast<int>(out.back().second) + 1) break;
    out.emplace_back(c, part);
  }
  return out;
}

/// Whole minutes of a clock.
bool holds_minutes(const CsvTable& table, std::size_t column) {
  return table.is_clock[column] != 0 && std::all_of(table.values[column].begin(), table.values[column].end(),
                                                    [](double s) { return std::isnan(s) || std::fmod(s, 60.0) == 0; });
}

double seconds_of_part(TimePart part, double value) {
  constexpr std::array<double, 7> seconds{0, 0, 86400, 3600, 60, 1, 1e-3};
  return seconds[static_cast<std::size_t>(part)] * value;
}

/// Seconds of the parts of one row.
double seconds_in_row(const CsvTable& table, const std::vector<std::pair<std::size_t, TimePart>>& parts,
                      std::size_t row) {
  double sum_s = 0;
  int year = 0;
  unsigned month = 0;
  for (const auto& [column, part] : parts) {
    const double value = table.values[column][row];
    if (!std::isfinite(value)) return no_value;
    if (part == TimePart::year) year = static_cast<int>(value);
    if (part == TimePart::month) month = static_cast<unsigned>(value);
    sum_s += seconds_of_part(part, value);
  }
  if (year == 0) return sum_s;
  const std::chrono::year_month_day first{std::chrono::year{year}, std::chrono::month{month}, std::chrono::day{1}};
  const auto days = std::chrono::sys_days(first).time_since_epoch().count() - 1;
  return sum_s + seconds_of_part(TimePart::day, static_cast<double>(days));
}

/// Whether a column beside the parts is a time that goes on in every row.
bool has_whole_time(const CsvTable& table, const std::vector<std::pair<std::size_t, TimePart>>& parts) {
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    if (std::any_of(parts.begin(), parts.end(), [c](const auto& part) { return part.first == c; })) continue;
    const std::vector<double>& values = table.values[c];
    if (table.is_clock[c] == 0 && !(named_time_s(table, c) > 0)) continue;
    if (values.size() > 1 && std::adjacent_find(values.begin(), values.end(), [](double before, double after) {
                               return !(after > before);
                             }) == values.end())
      return true;
  }
  return false;
}

}  // namespace

void join_time_parts(CsvTable& table) {
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    const auto parts = parts_from(table, c);
    const bool is_behind_minutes = c > 0 && holds_minutes(table, c - 1);
    const bool has_seconds =
        std::any_of(parts.begin(), parts.end(), [](const auto& part) { return part.second == TimePart::second; });
    const TimePart largest = is_behind_minutes ? TimePart::second : TimePart::minute;
    if (!has_seconds || parts.front().second > largest) continue;
    if (is_behind_minutes && parts.front().second != TimePart::second) continue;
    if (parts.front().second == TimePart::month || parts.front().second == TimePart::day) continue;
    if (has_whole_time(table, parts)) continue;
    std::vector<double> seconds(table.rows());
    for (std::size_t row = 0; row < table.rows(); ++row)
      seconds[row] = seconds_in_row(table, parts, row) + (is_behind_minutes ? table.values[c - 1][row] : 0);
    std::set<std::string> joined;
    std::vector<std::string> told;
    const std::size_t kept = is_behind_minutes ? c - 1 : c;
    if (is_behind_minutes) told.push_back(table.names[kept]);
    for (const auto& [column, part] : parts) {
      told.push_back(table.names[column]);
      if (column != kept) joined.insert(table.names[column]);
    }
    table.report(0, ProblemKind::dialect, fmt::format("columns {} are taken for one time", fmt::join(told, ", ")));
    table.values[kept] = std::move(seconds);
    table.is_clock[kept] = 1;
    table.units[kept].clear();
    return table.keep_columns([&](const std::string& name) { return !joined.contains(name); });
  }
}

namespace {

constexpr double gap_at_minute = 40;  ///< from 59 to 100 as numbers

/// The median step within minutes; no value where there is none.
double step_within_minutes(const std::vector<double>& values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (const double step = values[i] - values[i - 1]; std::abs(step) < gap_at_minute) steps.push_back(step);
  return steps.empty() ? no_value : median_of(std::move(steps));
}

}  // namespace

void read_digits_of_day(CsvTable& table) {
  constexpr double first_beyond = 240000, parts = 100, minute_s = 60, hour_s = 3600, few = 4;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    if (table.is_clock[c] != 0 || named_time_s(table, c) != 1 || !stated_unit(table, c).empty()) continue;
    const std::vector<double>& values = table.values[c];
    const double usual = step_within_minutes(values);
    std::vector<double> seconds;
    bool are_digits = true;
    std::size_t minutes = 0;
    double before = no_value, before_s = no_value;
    for (const double value : values) {
      const double whole = std::floor(value), second = std::fmod(value, parts),
                   minute = std::fmod(std::floor(whole / parts), parts);
      const double now_s = hour_s * std::floor(whole / (parts * parts)) + minute_s * minute + second;
      seconds.push_back(now_s);
      if (!std::isfinite(value)) continue;
      const bool ends_minute = value - before >= gap_at_minute;
      are_digits = are_digits && value >= 0 && value < first_beyond && second < minute_s && minute < minute_s &&
                   (!ends_minute || (now_s > before_s && now_s - before_s <= few * usual));
      minutes += ends_minute;
      before = value, before_s = now_s;
    }
    if (!are_digits || minutes == 0 || few * static_cast<double>(minutes) > static_cast<double>(values.size()))
      continue;
    table.values[c] = std::move(seconds);
    table.is_clock[c] = 1;
    table.report(0, ProblemKind::dialect,
                 fmt::format("{} holds times of day as hhmmss: so they go on where a minute ends", table.names[c]));
  }
}

}  // namespace pneuservo
