// Times that stand in more than one column of a table.
#include "record/table_times.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "record/column_guess.hpp"
#include "record/column_words.hpp"
#include "record/field_text.hpp"
#include "record/timed_groups.hpp"
#include "record/units.hpp"

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
  constexpr std::array<std::pair<std::string_view, double>, 17> words{{{"ms", 1e-3},
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
  const std::string word = last_word(name);
  const auto at = std::find_if(words.begin(), words.end(), [&](const auto& one) { return one.first == word; });
  return at == words.end() ? 0 : at->second;
}

bool is_time(const std::string& name) {
  const std::optional<ColumnWord> word = column_word(name);
  return word && word->ours == "t_s";
}

/// Of a name that says nothing else than a time, or is one word that is not known: "Millitm".
bool may_be_fraction(const std::string& name) {
  if (column_word(name)) return is_time(name);
  return std::all_of(name.begin(), name.end(), [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; });
}

bool counts_seconds(const CsvTable& table, std::size_t column) {
  constexpr std::array<std::string_view, 5> words{"s", "sec", "secs", "second", "seconds"};
  const std::string word = last_word(table.names[column]);
  return table.is_clock[column] != 0 ||
         (std::find(words.begin(), words.end(), word) != words.end() && is_time(table.names[column]));
}

bool are_whole(const std::vector<double>& values, double least, double most) {
  return std::all_of(values.begin(), values.end(),
                     [&](double v) { return std::isnan(v) || (v == std::round(v) && v >= least && v <= most); });
}

struct StatedInterval {
  double interval_s = 0;
  std::string line;
};

/// The first number of the text, with the rows' decimal sign or a point; `text` begins behind it. 0: none.
double take_first_number(std::string_view& text, char decimal) {
  const std::string_view rest = text.substr(std::min(text.find_first_of("0123456789"), text.size()));
  for (const char sign : {decimal, '.'}) {
    std::size_t end = std::min(rest.find_first_not_of(std::string("0123456789eE+-") + sign), rest.size());
    while (end > 0 && !std::isdigit(static_cast<unsigned char>(rest[end - 1]))) --end;
    const std::string_view number = rest.substr(0, end);
    double value = 0;
    if (!number_in(number, sign, value) || value <= 0) continue;
    text = rest.substr(end);
    return value;
  }
  return 0;
}

/// Seconds or hertz of the text's first number, by the unit behind it or in brackets before; 0: none.
double first_quantity(std::string_view text, bool is_rate, char decimal) {
  constexpr std::array<std::pair<std::string_view, double>, 13> rates{{{"mhz", 1e6},
                                                                       {"khz", 1e3},
                                                                       {"hz", 1},
                                                                       {"ms/s", 1e6},
                                                                       {"ks/s", 1e3},
                                                                       {"s/s", 1},
                                                                       {"1/s", 1},
                                                                       {"sps", 1},
                                                                       {"ksps", 1e3},
                                                                       {"msa/s", 1e6},
                                                                       {"ksa/s", 1e3},
                                                                       {"sa/s", 1},
                                                                       {"samples/s", 1}}};
  const std::size_t open = text.find_first_of("[("), close = text.find_first_of("])");
  const std::string_view before = open < close && close < text.size() ? text.substr(open, close + 1 - open) : "";
  const double value = take_first_number(text, decimal);
  text = trimmed(text);
  const std::string_view behind = text.substr(0, std::min(text.find_first_of(" \t,;\"])"), text.size()));
  for (const std::string_view unit : {behind, without_brackets(before)}) {
    const std::string name = in_small_letters(unit);
    const auto rate = std::find_if(rates.begin(), rates.end(), [&](const auto& one) { return one.first == name; });
    if (rate != rates.end()) return is_rate ? rate->second * value : 0;
    if (const auto time = unit_in(unit); time && time->quantity == Quantity::time)
      return is_rate ? 0 : time->factor * value;
  }
  const bool is_next_number = !behind.empty() && std::isdigit(static_cast<unsigned char>(behind.front())) != 0;
  return (behind.empty() || is_next_number) && before.empty() ? value : 0;
}

/// What a line such as "Sample rate: 1000 Hz", "Delta_X 0.001" or "Abtastintervall;1 ms" says; none where no line does.
std::optional<StatedInterval> stated_interval(const std::string& comments, char decimal) {
  constexpr std::array<std::string_view, 17> intervals{
      "sampleinterval", "samplinginterval", "sampleperiod", "samplingperiod", "sampletime",      "samplingtime",
      "deltax",         "deltat",           "dt",           "wfdelta",        "abtastintervall", "abtastzeit",
      "interval",       "hresolution",      "xincrement",   "timestep",       "increment"};
  constexpr std::array<std::string_view, 8> rates{
      "samplerate",     "samplingrate", "samplingfrequency", "samplefrequency", "abtastrate",
      "abtastfrequenz", "fs",           "messrate"};
  const auto has = [](const auto& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  for (std::string_view rest = comments; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    std::string label;
    for (const char c : line.substr(0, line.find_first_of("0123456789:=;,\t[(")))
      if (std::isalpha(static_cast<unsigned char>(c))) label += c;
    label = in_small_letters(label);
    const bool is_rate = has(rates, label);
    if (!is_rate && !has(intervals, label)) continue;
    const double value = first_quantity(line, is_rate, decimal);
    if (value > 0) return StatedInterval{is_rate ? 1 / value : value, shown(line)};
  }
  return std::nullopt;
}

}  // namespace

namespace {

/// "x [m]": "x".
std::string_view without_unit(std::string_view name) {
  const std::size_t open = name.find_first_of("[(");
  const bool is_number = open + 1 < name.size() && std::isdigit(static_cast<unsigned char>(name[open + 1])) != 0;
  return is_number ? name : trimmed(name.substr(0, std::min(open, name.size())));
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
  constexpr double any = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < table.names.size(); ++c)
    for (std::size_t f = 0; f < table.names.size(); ++f) {
      const double count_s = fraction_s(table.names[f]);
      if (f == c || count_s == 0 || !may_be_fraction(table.names[f]) || !counts_seconds(table, c)) continue;
      if (!are_whole(table.values[f], 0, std::round(1 / count_s) - 1) || !are_whole(table.values[c], -any, any))
        continue;
      std::vector<double> joined = table.values[c];
      for (std::size_t i = 0; i < joined.size(); ++i) joined[i] += count_s * table.values[f][i];
      if (known_in(joined) < known_in(table.values[c]) || steps_back(joined) > steps_back(table.values[c])) continue;
      table.values[c] = std::move(joined);
      table.report(0, ProblemKind::dialect,
                   fmt::format("column {} is taken for the {} of {}", table.names[f],
                               count_s > 1e-4   ? "milliseconds"
                               : count_s > 1e-7 ? "microseconds"
                                                : "nanoseconds",
                               table.names[c]));
      break;
    }
}

void count_rows(CsvTable& table, char decimal, const std::vector<MissingRows>& missing) {
  const std::vector<ColumnGuess> guesses = guess_columns(table);
  for (std::size_t c = 0; c < guesses.size(); ++c)
    if ((table.is_clock[c] != 0 || guesses[c].ours == "t_s") && known_in(table.values[c]) > 0) return;
  if (std::find(table.names.begin(), table.names.end(), "t_s") != table.names.end() || sum_intervals(table, missing))
    return;
  const std::optional<StatedInterval> stated = stated_interval(table.comments, decimal);
  if (!stated) return;
  add_times(table);
  long long row = 0;
  auto next = missing.begin();
  for (std::size_t i = 0; i < table.line_numbers.size(); ++i, ++row) {
    for (; next != missing.end() && next->before <= i; ++next) row += i > 0 ? next->count : 0;
    table.values.back().push_back(stated->interval_s * static_cast<double>(row));
  }
  table.report(0, ProblemKind::dialect,
               fmt::format("no column holds times: rows are counted as t_s, {:g} s apart by \"{}\" in the head",
                           stated->interval_s, stated->line));
}

}  // namespace pneuservo
