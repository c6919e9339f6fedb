// Times that stand in more than one column of a table.
#include "record/table_times.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "record/column_guess.hpp"
#include "record/column_words.hpp"
#include "record/field_text.hpp"
#include "record/units.hpp"

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

void count_rows(CsvTable& table, char decimal) {
  const std::vector<ColumnGuess> guesses = guess_columns(table);
  for (std::size_t c = 0; c < guesses.size(); ++c)
    if ((table.is_clock[c] != 0 || guesses[c].ours == "t_s") && known_in(table.values[c]) > 0) return;
  const std::optional<StatedInterval> stated = stated_interval(table.comments, decimal);
  if (!stated || std::find(table.names.begin(), table.names.end(), "t_s") != table.names.end()) return;
  table.names.emplace_back("t_s");
  table.units.emplace_back();
  table.is_clock.push_back(0);
  table.values.emplace_back();
  for (std::size_t i = 0; i < table.line_numbers.size(); ++i)
    table.values.back().push_back(stated->interval_s * static_cast<double>(i));
  table.report(0, ProblemKind::dialect,
               fmt::format("no column holds times: rows are counted as t_s, {:g} s apart by \"{}\" in the head",
                           stated->interval_s, stated->line));
}

}  // namespace pneuservo
