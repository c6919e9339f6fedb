// The interval or the rate of the rows as a table's head or its column names state it.
#include "record/foreign/stated_interval.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "record/column_values.hpp"
#include "record/foreign/field_text.hpp"
#include "record/foreign/units.hpp"

namespace pneuservo {

namespace {

enum class LabelPart { rate, interval, time, sampling, filler, unit };

struct LabelWord {
  std::string_view text;
  LabelPart part;
};

/// Words that labels of rates and intervals are joined of; any other word makes the label one of something else.
constexpr std::array label_words{
    LabelWord{"rate", LabelPart::rate},
    LabelWord{"frequency", LabelPart::rate},
    LabelWord{"freq", LabelPart::rate},
    LabelWord{"frequenz", LabelPart::rate},
    LabelWord{"frequence", LabelPart::rate},
    LabelWord{"fréquence", LabelPart::rate},
    LabelWord{"frecuencia", LabelPart::rate},
    LabelWord{"frequência", LabelPart::rate},
    LabelWord{"frequenza", LabelPart::rate},
    LabelWord{"taux", LabelPart::rate},
    LabelWord{"tasa", LabelPart::rate},
    LabelWord{"taxa", LabelPart::rate},
    LabelWord{"fs", LabelPart::rate},
    LabelWord{"persecond", LabelPart::rate},
    LabelWord{"persec", LabelPart::rate},
    LabelWord{"samplessec", LabelPart::rate},
    LabelWord{"sampless", LabelPart::rate},
    LabelWord{"周波数", LabelPart::rate},
    LabelWord{"レート", LabelPart::rate},
    LabelWord{"频率", LabelPart::rate},
    LabelWord{"頻率", LabelPart::rate},
    LabelWord{"率", LabelPart::rate},
    LabelWord{"interval", LabelPart::interval},
    LabelWord{"intervall", LabelPart::interval},
    LabelWord{"intervalle", LabelPart::interval},
    LabelWord{"intervalo", LabelPart::interval},
    LabelWord{"intervallo", LabelPart::interval},
    LabelWord{"period", LabelPart::interval},
    LabelWord{"periode", LabelPart::interval},
    LabelWord{"période", LabelPart::interval},
    LabelWord{"periodo", LabelPart::interval},
    LabelWord{"período", LabelPart::interval},
    LabelWord{"timebase", LabelPart::interval},
    LabelWord{"zeitbasis", LabelPart::interval},
    LabelWord{"dt", LabelPart::interval},
    LabelWord{"delta", LabelPart::interval},
    LabelWord{"wfdelta", LabelPart::interval},
    LabelWord{"hresolution", LabelPart::interval},
    LabelWord{"increment", LabelPart::interval},
    LabelWord{"tinc", LabelPart::interval},
    LabelWord{"xinc", LabelPart::interval},
    LabelWord{"step", LabelPart::interval},
    LabelWord{"周期", LabelPart::interval},
    LabelWord{"週期", LabelPart::interval},
    LabelWord{"間隔", LabelPart::interval},
    LabelWord{"间隔", LabelPart::interval},
    LabelWord{"time", LabelPart::time},
    LabelWord{"zeit", LabelPart::time},
    LabelWord{"temps", LabelPart::time},
    LabelWord{"tiempo", LabelPart::time},
    LabelWord{"tempo", LabelPart::time},
    LabelWord{"時間", LabelPart::time},
    LabelWord{"时间", LabelPart::time},
    LabelWord{"sample", LabelPart::sampling},
    LabelWord{"samples", LabelPart::sampling},
    LabelWord{"sampling", LabelPart::sampling},
    LabelWord{"scan", LabelPart::sampling},
    LabelWord{"acquisition", LabelPart::sampling},
    LabelWord{"abtast", LabelPart::sampling},
    LabelWord{"mess", LabelPart::sampling},
    LabelWord{"log", LabelPart::sampling},
    LabelWord{"logging", LabelPart::sampling},
    LabelWord{"recording", LabelPart::sampling},
    LabelWord{"cycle", LabelPart::sampling},
    LabelWord{"zyklus", LabelPart::sampling},
    LabelWord{"échantillonnage", LabelPart::sampling},
    LabelWord{"echantillonnage", LabelPart::sampling},
    LabelWord{"acquisizione", LabelPart::sampling},
    LabelWord{"muestreo", LabelPart::sampling},
    LabelWord{"campionamento", LabelPart::sampling},
    LabelWord{"amostragem", LabelPart::sampling},
    LabelWord{"サンプリング", LabelPart::sampling},
    LabelWord{"サンプル", LabelPart::sampling},
    LabelWord{"采样", LabelPart::sampling},
    LabelWord{"採樣", LabelPart::sampling},
    LabelWord{"d", LabelPart::filler},
    LabelWord{"de", LabelPart::filler},
    LabelWord{"di", LabelPart::filler},
    LabelWord{"x", LabelPart::filler},
    LabelWord{"t", LabelPart::filler},
    LabelWord{"hz", LabelPart::unit},
    LabelWord{"khz", LabelPart::unit},
    LabelWord{"ms", LabelPart::unit},
    LabelWord{"us", LabelPart::unit},
    LabelWord{"ns", LabelPart::unit},
    LabelWord{"s", LabelPart::unit},
};

/// What a label says: of an interval or a rate, and whether of sampling by its words.
struct IntervalLabel {
  bool is_rate = false, is_sampling = false;
  bool is_bare = false;  ///< may as well be of the motion
  std::string_view unit;
};

/// Rates below 50 Hz and their intervals under a bare label may be those of a motion.
constexpr double longest_bare_s = 0.02;

/// Words that say as much of a motion, a signal or a test as of the rows.
bool is_said_of_motions(std::string_view word) {
  constexpr std::array<std::string_view, 20> words{"frequency",  "freq",       "frequenz",  "frequence", "fréquence",
                                                   "frecuencia", "frequência", "frequenza", "周波数",    "频率",
                                                   "頻率",       "period",     "periode",   "période",   "periodo",
                                                   "período",    "周期",       "週期",      "step",      "delta"};
  return std::ranges::find(words, word) != words.end();
}

std::string letters_of(std::string_view text) {
  std::string out;
  std::copy_if(text.begin(), text.end(), std::back_inserter(out), is_letter);
  return in_small_letters(out);
}

std::optional<IntervalLabel> interval_label(std::string_view text) {
  const std::string letters = letters_of(text);
  IntervalLabel out;
  bool has_kind = false, has_time = false, has_own_kind = false;
  for (std::string_view rest = letters; !rest.empty();) {
    const LabelWord* longest = nullptr;
    for (const LabelWord& word : label_words)
      if (rest.starts_with(word.text) && (longest == nullptr || word.text.size() > longest->text.size()) &&
          (word.part != LabelPart::unit || word.text.size() == rest.size()))
        longest = &word;
    if (longest == nullptr) return std::nullopt;
    out.is_rate = out.is_rate || longest->part == LabelPart::rate;
    const bool is_kind = longest->part == LabelPart::rate || longest->part == LabelPart::interval;
    has_kind = has_kind || is_kind;
    has_own_kind = has_own_kind || (is_kind && !is_said_of_motions(longest->text));
    has_time = has_time || longest->part == LabelPart::time;
    out.is_sampling = out.is_sampling || longest->part == LabelPart::sampling;
    if (longest->part == LabelPart::unit) out.unit = longest->text;
    rest.remove_prefix(longest->text.size());
  }
  out.is_bare = !has_own_kind && !has_time && !out.is_sampling;
  return has_kind || (has_time && out.is_sampling) ? std::optional(out) : std::nullopt;
}

/// "1,000" and "12,000,000", whose commas part thousands where points are decimal signs.
bool parts_thousands(std::string_view number) {
  constexpr std::size_t digits = 3;
  std::size_t comma = number.find(',');
  if (comma == 0 || comma > digits || number.front() == '0') return false;
  for (; comma < number.size(); comma += digits + 1)
    if (number[comma] != ',' || number.size() < comma + digits + 1) return false;
  return comma == number.size() && number.find_first_not_of("0123456789,") == std::string_view::npos;
}

/// The first number of the text, with the rows' decimal sign or the other; `text` begins behind it. 0: none.
double take_first_number(std::string_view& text, char decimal) {
  const std::string_view rest = text.substr(std::min(text.find_first_of("0123456789"), text.size()));
  for (const char sign : {decimal, '.', ','}) {
    std::size_t end = std::min(rest.find_first_not_of("0123456789eE+-.,"), rest.size());
    while (end > 0 && !std::isdigit(static_cast<unsigned char>(rest[end - 1]))) --end;
    std::string number(rest.substr(0, end));
    if (decimal == '.' && parts_thousands(number)) std::erase(number, ',');
    double value = 0;
    if (!number_in(number, sign, value) || value <= 0) continue;
    text = rest.substr(end);
    return value;
  }
  return 0;
}

/// Seconds of the text's first number, by the unit behind it, in brackets before or of its label; 0: none.
double stated_seconds(std::string_view text, const IntervalLabel& label, std::string_view unit_beside, char decimal) {
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
  const double value = take_first_number(text, decimal);
  if (value == 0) return 0;
  text = trimmed(text);
  std::string_view behind = text.substr(0, std::min(text.find_first_of(" \t,;\"])"), text.size()));
  if (behind.ends_with('.')) behind.remove_suffix(1);
  const bool is_unit = !behind.empty() && std::isdigit(static_cast<unsigned char>(behind.front())) == 0;
  for (const std::string_view unit : {is_unit ? behind : std::string_view(), unit_beside, label.unit}) {
    if (unit.empty()) continue;
    const std::string name = in_small_letters(unit);
    const auto rate = std::find_if(rates.begin(), rates.end(), [&](const auto& one) { return one.first == name; });
    if (rate != rates.end()) return 1 / (rate->second * value);
    if (const auto time = unit_in(unit); time && time->quantity == Quantity::time) return time->factor * value;
    return 0;  // of something else
  }
  return label.is_rate ? 1 / value : value;
}

/// A line of a head: its label, a unit in brackets behind it, and what stands behind both.
struct LabelledText {
  std::string_view label, unit, value;
  char sign = ' ';  ///< between label and value

  explicit LabelledText(std::string_view line) {
    const std::size_t end = std::min(line.find_first_of("0123456789:=;,\t[("), line.size());
    label = line.substr(0, end);
    value = line.substr(end);
    if (value.starts_with('[') || value.starts_with('(')) {
      const std::size_t close = std::min(value.find_first_of("])"), value.size());
      unit = without_brackets(value.substr(0, std::min(close + 1, value.size())));
      value = trimmed(value.substr(std::min(close + 1, value.size())));
    }
    if (!value.empty() && std::string_view(":=;,\t").find(value.front()) != std::string_view::npos) {
      sign = value.front();
      value.remove_prefix(1);
    }
  }
};

std::vector<std::string_view> parts_between(std::string_view text, char sign) {
  std::vector<std::string_view> out;
  split_fields(text, {sign}, out);
  return out;
}

/// Intervals of a line that holds one for each column: "Delta_X;0.001;0.002", "rate = 1 kHz;rate = 500 Hz"; else of
/// its one value; empty: none.
std::vector<double> intervals_of(std::string_view line, const IntervalLabel& label, const FieldStyle& style) {
  const LabelledText text(line);
  std::vector<double> out;
  for (const char sign : {style.separator, '\t', ';'}) {
    if (line.find(sign) == std::string_view::npos || sign == ' ') continue;
    for (const std::string_view part : parts_between(line, sign)) {
      const LabelledText one(part);
      const std::optional<IntervalLabel> own = interval_label(one.label);
      const double interval_s = own ? stated_seconds(one.value, *own, one.unit, style.decimal) : 0;
      if (interval_s > 0) out.push_back(interval_s);
    }
    if (out.size() > 1) return out;
    out.clear();
  }
  const bool is_list = text.sign == ';' || text.sign == ',' || text.sign == '\t';
  if (is_list || text.sign == ' ') {
    const std::vector<std::string_view> parts = parts_between(trimmed(text.value), text.sign);
    const std::string_view beside = parts.size() > 1 && text.unit.empty() && unit_in(parts[1]) ? parts[1] : text.unit;
    double number = 0;
    for (const std::string_view part : parts) {
      if (!out.empty() && !number_in(part, style.decimal, number) && !number_in(part, '.', number)) break;
      const double interval_s = stated_seconds(part, label, beside, style.decimal);
      if (interval_s > 0) out.push_back(interval_s);
    }
    if (out.size() > 1 || is_list) return out;
  }
  if (const double interval_s = stated_seconds(text.value, label, text.unit, style.decimal); interval_s > 0)
    return {interval_s};
  return {};
}

/// "X0;0;0.05": numbers behind a label.
std::vector<double> numbers_behind(std::string_view line, std::string_view label, char decimal) {
  std::vector<double> out;
  const std::size_t end = std::min(line.find_first_of(",;\t "), line.size());
  if (in_small_letters(line.substr(0, end)) != label || end == line.size()) return out;
  for (const std::string_view part : parts_between(line.substr(end + 1), line[end])) {
    double number = 0;
    if (!number_in(part, decimal, number) && !number_in(part, '.', number)) break;
    out.push_back(number);
  }
  return out;
}

/// Of a column without values that is named so ("tInc = 0.001", "Increment" with a number in the row of units), and of
/// one whose name holds a rate ("Sample (1 kHz)").
std::optional<StatedInterval> interval_in_names(const CsvTable& table, char decimal) {
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    const LabelledText text(table.names[c]);
    const std::string_view value = text.value.empty() ? std::string_view(table.units[c]) : text.value;
    const std::optional<IntervalLabel> label = interval_label(text.label);
    double interval_s = label && !has_value(table.values[c]) ? stated_seconds(value, *label, text.unit, decimal) : 0;
    std::string_view in_brackets = text.unit;
    const bool is_rate = !in_brackets.empty() && in_small_letters(in_brackets).ends_with("hz") &&
                         std::isdigit(static_cast<unsigned char>(in_brackets.front())) != 0;
    if (is_rate) interval_s = stated_seconds(in_brackets, {true, true, false, ""}, "", decimal);
    if (interval_s > 0) return StatedInterval{{interval_s}, {}, table.names[c]};
  }
  return std::nullopt;
}

/// "Decimation: 2": of so many samples one is a row; 1 where the line says nothing of it.
double rows_left_out(std::string_view line, char decimal) {
  const LabelledText text(line);
  const std::string letters = letters_of(text.label);
  if (letters != "decimation" && letters != "decimationfactor" && letters != "dezimation" && letters != "downsampling")
    return 1;
  std::string_view value = text.value;
  const double factor = take_first_number(value, decimal);
  return factor >= 1 && factor == std::round(factor) ? factor : 1;
}

}  // namespace

std::optional<StatedInterval> stated_interval(const CsvTable& table, const FieldStyle& style) {
  std::optional<StatedInterval> out;
  std::vector<double> starts;
  double left_out = 1;
  std::string left_out_line;
  bool is_sampling = false;
  for (std::string_view rest = table.comments; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string half = half_width(rest.substr(0, end));
    const std::string_view line = trimmed(half);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (starts.empty()) starts = numbers_behind(line, "x0", style.decimal);
    if (const double factor = rows_left_out(line, style.decimal); factor > 1)
      left_out = factor, left_out_line = shown(line);
    const std::optional<IntervalLabel> label = interval_label(LabelledText(line).label);
    if (!label || (out && (is_sampling || !label->is_sampling))) continue;
    const std::vector<double> intervals = intervals_of(line, *label, style);
    if (intervals.empty() || (label->is_bare && std::ranges::max(intervals) > longest_bare_s)) continue;
    out = StatedInterval{intervals, {}, shown(line)};
    is_sampling = label->is_sampling;
  }
  if (!out) out = interval_in_names(table, style.decimal);
  if (!out) return out;
  for (double& interval_s : out->intervals_s) interval_s *= left_out;
  if (left_out > 1) out->line += "\" and \"" + left_out_line;
  out->starts_s = std::move(starts);
  return out;
}

}  // namespace pneuservo
