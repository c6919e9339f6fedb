// Times that stand in more than one column of a table.
#include "record/foreign/table_times.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/foreign/column_words.hpp"
#include "record/foreign/stated_interval.hpp"
#include "record/foreign/time_parts.hpp"
#include "record/foreign/timed_groups.hpp"

namespace pneuservo {

namespace {

bool is_same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

/// The last word of letters, small: "usec" of "tv_usec".
std::string last_word(const std::string& name) {
  std::string word;
  for (const char c : name) {
    const auto now = static_cast<unsigned char>(c);
    if (std::isalpha(now)) word += static_cast<char>(std::tolower(now));
    else if (&c != &name.back()) word.clear();
  }
  return word;
}

/// Seconds of one count of a column of fractions, by the last word of its name; 0: of none.
double fraction_s(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, double>, 19> words{{{"fraction", 1},
                                                                       {"frac", 1},
                                                                       {"ms", 1e-3},
                                                                       {"msec", 1e-3},
                                                                       {"msecs", 1e-3},
                                                                       {"millis", 1e-3},
                                                                       {"millitm", 1e-3},
                                                                       {"millisecond", 1e-3},
                                                                       {"milliseconds", 1e-3},
                                                                       {"millisekunden", 1e-3},
                                                                       {"us", 1e-6},
                                                                       {"usec", 1e-6},
                                                                       {"usecs", 1e-6},
                                                                       {"microseconds", 1e-6},
                                                                       {"ns", 1e-9},
                                                                       {"nsec", 1e-9},
                                                                       {"nsecs", 1e-9},
                                                                       {"nanosec", 1e-9},
                                                                       {"nanoseconds", 1e-9}}};
  std::string word = last_word(name);
  // "Elapsed [ms]" goes on behind a second, what is named a fraction does not.
  if (name.ends_with(']') && in_small_letters(name).starts_with("frac"))
    word = last_word(name.substr(0, name.size() - 1));
  const auto at = std::find_if(words.begin(), words.end(), [&](const auto& one) { return one.first == word; });
  return at == words.end() ? 0 : at->second;
}

/// "x [m]": "x".
std::string_view without_unit(std::string_view name) {
  const std::size_t open = name.find_first_of("[(");
  const bool is_number = open + 1 < name.size() && std::isdigit(static_cast<unsigned char>(name[open + 1])) != 0;
  return is_number ? name : trimmed(name.substr(0, std::min(open, name.size())));
}

bool is_time(const std::string& name) {
  const std::optional<ColumnWord> word = column_word(name);
  return word && word->ours == "t_s";
}

/// Of a name that says nothing else than a time, or is one word that is not known: "Millitm".
bool may_be_fraction(const std::string& name) {
  if (const double whole_s = fraction_s(std::string(without_unit(name))); whole_s == 1) return true;
  if (column_word(name)) return is_time(name);
  const std::string_view word = without_unit(name);
  return std::all_of(word.begin(), word.end(), [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; });
}

bool are_whole(const std::vector<double>& values, double least, double most) {
  return std::all_of(values.begin(), values.end(),
                     [&](double v) { return std::isnan(v) || (v == std::round(v) && v >= least && v <= most); });
}

/// "t3 [s]" and "t1 [s]", "Time (2)" and "Time", "Time A" and "Time B": the same but for the number or letter.
bool is_numbered_alike(std::string_view a, std::string_view b) {
  const auto letters = [](std::string_view name) {
    std::string out(without_unit(name));
    const bool has_letter = out.size() > 2 && std::isalnum(static_cast<unsigned char>(out[out.size() - 2])) == 0;
    if (has_letter) out.pop_back();
    std::erase_if(out, [](char c) { return std::string_view("0123456789 ()_#.").find(c) != std::string_view::npos; });
    return out;
  };
  return letters(a) == letters(b);
}

/// "Time_x [s]", "x_t" or "tx" before "x [m]".
bool is_named_after(std::string_view time, std::string_view value) {
  const std::string name = in_small_letters(without_unit(time)), whose = in_small_letters(without_unit(value));
  if (whose.empty() || name.size() <= whose.size()) return false;
  const auto ends_apart = [&](char beside) {
    return name.size() == whose.size() + 1 || std::isalnum(static_cast<unsigned char>(beside)) == 0;
  };
  return (name.ends_with(whose) && ends_apart(name[name.size() - whose.size() - 1])) ||
         (name.starts_with(whose) && ends_apart(name[whose.size()]));
}

/// Whether most steps of the known values go on.
bool goes_on(const std::vector<double>& values) {
  std::size_t up = 0, back = 0;
  double last = no_value;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    up += value > last, back += value < last;
    last = value;
  }
  return up > 0 && up > 9 * back;
}

std::pair<double, double> range_of(const std::vector<double>& values) {
  double low = no_value, high = no_value;
  for (const double value : values)
    if (std::isfinite(value)) low = std::fmin(low, value), high = std::fmax(high, value);
  return {low, high};
}

/// A column of times: where it stands, and what its values are to be multiplied by for those of the first.
struct TimeColumn {
  std::size_t place = 0;
  double factor = 1;
};

/// Columns that are named as times and go on.
std::vector<TimeColumn> named_times(const CsvTable& table) {
  std::vector<TimeColumn> out;
  double first_s = 1;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    const double unit_s = table.is_clock[c] != 0 ? 1 : named_time_s(table, c);
    if (unit_s == 0 || !goes_on(table.values[c])) continue;
    if (out.empty()) first_s = unit_s;
    else if (table.is_clock[c] != table.is_clock[out.front().place]) return {};
    out.push_back({c, unit_s / first_s});
  }
  return out;
}

/// Whether the spans of all times have a moment in common.
bool overlap(const CsvTable& table, const std::vector<TimeColumn>& times) {
  double latest_start = -std::numeric_limits<double>::infinity(), first_end = -latest_start;
  for (const TimeColumn& time : times) {
    const auto [low, high] = range_of(table.values[time.place]);
    latest_start = std::max(latest_start, time.factor * low), first_end = std::min(first_end, time.factor * high);
  }
  return latest_start < first_end;
}

/// Times of the columns behind each, as their names and values say: they are numbered, or named after the one value
/// behind each, or end at other rows. Another stamp of the same rows, such as the receiver's, is none.
std::vector<TimeColumn> times_of_groups(const CsvTable& table) {
  const std::vector<TimeColumn> times = named_times(table);
  if (times.size() < 2 || times.front().place != 0 || times.back().place + 1 == table.names.size()) return {};
  bool are_named_after = true, are_numbered = true, end_apart = false;
  const auto count = [&](std::size_t c) {
    return std::count_if(table.values[c].begin(), table.values[c].end(), [](double v) { return std::isfinite(v); });
  };
  for (std::size_t i = 0; i < times.size(); ++i) {
    const std::size_t place = times[i].place;
    if (i > 0 && place == times[i - 1].place + 1) return {};
    are_named_after = are_named_after && place == 2 * i && is_named_after(table.names[place], table.names[place + 1]);
    are_numbered = are_numbered && is_numbered_alike(table.names[place], table.names[0]);
    end_apart = end_apart || count(place) != count(0);
  }
  return (are_named_after || are_numbered || end_apart) && overlap(table, times) ? times : std::vector<TimeColumn>();
}

std::vector<TimedGroup> groups_of(CsvTable& table, const std::vector<TimeColumn>& times) {
  std::vector<TimedGroup> out;
  for (std::size_t i = 0; i < times.size(); ++i) {
    TimedGroup group;
    group.times = std::move(table.values[times[i].place]);
    if (times[i].factor != 1)
      for (double& time : group.times) time *= times[i].factor;
    group.lines = table.line_numbers;
    const std::size_t end = i + 1 < times.size() ? times[i + 1].place : table.names.size();
    for (std::size_t c = times[i].place + 1; c < end; ++c) {
      group.names.push_back(table.names[c]);
      group.units.push_back(table.units[c]);
      group.values.push_back(std::move(table.values[c]));
    }
    out.push_back(std::move(group));
  }
  return out;
}

bool counts_seconds(const CsvTable& table, std::size_t column) {
  constexpr double least_s = 3e8, most_s = 3.3e9;  // since 1970: 1979 to 2074
  constexpr std::array<std::string_view, 5> words{"s", "sec", "secs", "second", "seconds"};
  const std::string word = last_word(table.names[column]);
  return table.is_clock[column] != 0 ||
         (std::find(words.begin(), words.end(), word) != words.end() && is_time(table.names[column])) ||
         ((is_time(table.names[column]) || word == "epoch") && are_whole(table.values[column], least_s, most_s));
}

}  // namespace

void join_times(CsvTable& table, bool has_pairs) {
  std::vector<TimeColumn> times;
  for (std::size_t c = 0; has_pairs && c + 1 < table.names.size(); c += 2) times.push_back({c, 1});
  if (!has_pairs) times = times_of_groups(table);
  const bool are_alike = std::all_of(times.begin(), times.end(), [&](const TimeColumn& time) {
    return time.factor == 1 && is_same(table.values[0], table.values[time.place]);
  });
  if (are_alike) return;
  std::string& name = table.names.front();  // of the channel behind it, as "x_t [s]"
  if (table.is_clock.front() == 0 && meaning_of(name) != "t_s")
    name = std::string(trimmed("Time " + name.substr(std::min(name.find_first_of("[("), name.size()))));
  join_groups(table, groups_of(table, times));
}

namespace {

auto known_in(const std::vector<double>& values) {
  return std::count_if(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

int steps_back(const std::vector<double>& times) {
  int count = 0;
  double last = -std::numeric_limits<double>::infinity();
  for (const double time : times) {
    if (!std::isfinite(time)) continue;
    count += time < last;
    last = time;
  }
  return count;
}

bool are_below_one(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isnan(v) || (v >= 0 && v < 1); });
}

/// A new column t_s, still empty.
void add_times(CsvTable& table) {
  table.names.emplace_back("t_s");
  table.units.emplace_back();
  table.is_clock.push_back(0);
  table.values.emplace_back();
}

/// Times as sums of a column that holds the time since the row before, missing rows being as long as the one behind
/// them; false where there is none.
bool sum_intervals(CsvTable& table, const std::vector<MissingRows>& missing) {
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    const double unit_s = named_interval_s(table, c);
    const std::vector<double>& intervals = table.values[c];
    if (unit_s == 0 || intervals.empty() ||
        !std::all_of(intervals.begin() + 1, intervals.end(), [](double interval) { return interval > 0; }))
      continue;
    std::vector<double> times{0.0};
    auto next = missing.begin();
    for (std::size_t i = 1; i < intervals.size(); ++i) {
      double rows = 1;
      for (; next != missing.end() && next->before <= i; ++next) rows += static_cast<double>(next->count);
      times.push_back(times.back() + rows * unit_s * intervals[i]);
    }
    table.report(
        0, ProblemKind::dialect,
        fmt::format("no column holds times: t_s is the sum of {}, the time since the row before", table.names[c]));
    add_times(table);
    table.values.back() = std::move(times);
    return true;
  }
  return false;
}

}  // namespace

void add_fractions(CsvTable& table) {
  read_digits_of_day(table);
  join_time_parts(table);
  constexpr double any = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < table.names.size(); ++c)
    for (std::size_t f = 0; f < table.names.size(); ++f) {
      const double count_s = fraction_s(table.names[f]);
      if (f == c || count_s == 0 || !may_be_fraction(table.names[f]) || !counts_seconds(table, c)) continue;
      const bool is_fraction =
          count_s == 1 ? are_below_one(table.values[f]) : are_whole(table.values[f], 0, std::round(1 / count_s) - 1);
      if (!is_fraction || !are_whole(table.values[c], -any, any)) continue;
      std::vector<double> joined = table.values[c];
      for (std::size_t i = 0; i < joined.size(); ++i) joined[i] += count_s * table.values[f][i];
      if (known_in(joined) < known_in(table.values[c]) || steps_back(joined) > steps_back(table.values[c])) continue;
      table.values[c] = std::move(joined);
      if (last_word(table.names[c]) == "epoch") table.is_clock[c] = 1;
      table.report(0, ProblemKind::dialect,
                   fmt::format("column {} is taken for the {} of {}", table.names[f],
                               count_s == 1     ? "fractions of a second"
                               : count_s > 1e-4 ? "milliseconds"
                               : count_s > 1e-7 ? "microseconds"
                                                : "nanoseconds",
                               table.names[c]));
      break;
    }
}

namespace {

/// Channels that are counted at intervals or from starts of their own, those of one rate together. `row` of each line.
std::vector<TimedGroup> counted_groups(CsvTable& table, const std::vector<std::size_t>& channels,
                                       const StatedInterval& stated, const std::vector<double>& row) {
  std::map<std::pair<double, double>, TimedGroup> groups;
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const double interval_s = stated.intervals_s[stated.intervals_s.size() == 1 ? 0 : k];
    const double start_s = stated.starts_s.size() == channels.size() ? stated.starts_s[k] : 0;
    TimedGroup& group = groups[{interval_s, start_s}];
    group.names.push_back(table.names[channels[k]]);
    group.units.push_back(table.units[channels[k]]);
    group.values.push_back(std::move(table.values[channels[k]]));
  }
  std::vector<TimedGroup> out;
  for (auto& [key, group] : groups) {
    std::size_t rows = 0;
    for (const auto& values : group.values)
      for (std::size_t i = rows; i < values.size(); ++i)
        if (std::isfinite(values[i])) rows = i + 1;
    for (auto& values : group.values) values.resize(rows);
    for (std::size_t i = 0; i < rows; ++i) group.times.push_back(key.second + key.first * row[i]);
    group.lines.assign(table.line_numbers.begin(), table.line_numbers.begin() + static_cast<std::ptrdiff_t>(rows));
    out.push_back(std::move(group));
  }
  return out;
}

/// Whether the head states intervals or starts that differ; throws InputError where it is not one for each channel.
bool differ_by_channel(const CsvTable& table, std::size_t channels, const StatedInterval& stated) {
  const auto differ = [](const std::vector<double>& of) {
    return std::adjacent_find(of.begin(), of.end(), std::not_equal_to<>()) != of.end();
  };
  const bool have_rates = differ(stated.intervals_s), have_starts = differ(stated.starts_s);
  if ((have_rates && stated.intervals_s.size() != channels) || (have_starts && stated.starts_s.size() != channels))
    throw InputError(
        fmt::format("{}: the head states {} intervals that differ (\"{}\"), expected one for each of the {} "
                    "columns with values; write the columns of each rate to a file of its own, or give "
                    "each a column of times",
                    table.path, std::max(stated.intervals_s.size(), stated.starts_s.size()), stated.line, channels));
  return have_rates || have_starts;
}

/// Numbers of the rows, the missing ones counted.
std::vector<double> row_numbers(const CsvTable& table, const std::vector<MissingRows>& missing) {
  std::vector<double> out;
  long long row = 0;
  auto next = missing.begin();
  for (std::size_t i = 0; i < table.line_numbers.size(); ++i, ++row) {
    for (; next != missing.end() && next->before <= i; ++next) row += i > 0 ? next->count : 0;
    out.push_back(static_cast<double>(row));
  }
  return out;
}

}  // namespace

void count_rows(CsvTable& table, const FieldStyle& style, const std::vector<MissingRows>& missing) {
  const std::vector<ColumnGuess> guesses = guess_columns(table);
  std::size_t empty_time = table.names.size();
  std::vector<std::size_t> channels;
  for (std::size_t c = 0; c < guesses.size(); ++c) {
    const bool has_values = known_in(table.values[c]) > 0, is_time = table.is_clock[c] != 0 || guesses[c].ours == "t_s";
    if (is_time && has_values) return;
    if (is_time) empty_time = c;
    if (has_values) channels.push_back(c);
  }
  const bool is_named_ours = std::find(table.names.begin(), table.names.end(), "t_s") != table.names.end();
  if (is_named_ours || sum_intervals(table, missing)) return;
  const std::optional<StatedInterval> stated = stated_interval(table, style);
  if (!stated) return;
  const std::vector<double> row = row_numbers(table, missing);
  if (differ_by_channel(table, channels.size(), *stated)) {
    table.report(0, ProblemKind::dialect,
                 fmt::format("no column holds times: the rows of each column are counted at its own interval by \"{}\" "
                             "in the head{}",
                             stated->line, stated->starts_s.empty() ? "" : ", from its own start by X0"));
    std::vector<TimedGroup> groups = counted_groups(table, channels, *stated, row);
    table.names.front() = "t_s", table.units.front().clear(), table.is_clock.front() = 0;
    return join_groups(table, std::move(groups));
  }
  const double interval_s = stated->intervals_s.front();
  if (empty_time < table.names.size()) {
    const std::string empty = table.names[empty_time];
    table.keep_columns([&](const std::string& name) { return name != empty; });
  }
  add_times(table);
  for (const double number : row) table.values.back().push_back(interval_s * number);
  table.report(0, ProblemKind::dialect,
               fmt::format("no column holds times: rows are counted as t_s, {:g} s apart by \"{}\" in the head",
                           interval_s, stated->line));
}

}  // namespace pneuservo
