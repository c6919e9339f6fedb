// Long tables: a row for each value, with the name of its channel.
#include "record/foreign/long_rows.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "record/foreign/clock_text.hpp"
#include "record/foreign/column_words.hpp"
#include "record/foreign/names_text.hpp"
#include "record/foreign/units.hpp"
#include "record/table_bound.hpp"

namespace pneuservo {

namespace {

constexpr std::size_t least_long_rows = 4;  ///< that show two channels twice
constexpr std::size_t most_fields = 40;
constexpr double share_of_rows = 0.9;  ///< of the lines, that must be such rows; the others are remarks

constexpr std::array<std::string_view, 46> tag_words{
    "channel",       "channelname", "channelid", "tag",         "tagname",     "tagid",         "name",
    "variable",      "varname",     "signal",    "signalname",  "topic",       "sensor",        "sensorname",
    "sensorid",      "measurement", "metric",    "point",       "pointname",   "item",          "itemname",
    "itemid",        "node",        "nodeid",    "nodename",    "displayname", "browsename",    "parameter",
    "parametername", "series",      "field",     "key",         "entityid",    "attribute",     "label",
    "quantity",      "kanal",       "kanalname", "messstelle",  "bezeichnung", "variablenname", "groesse",
    "canal",         "voie",        "grandeur",  "variablename"};
constexpr std::array<std::string_view, 14> value_words{"value",  "values",  "val",      "wert",        "messwert",
                                                       "valeur", "valor",   "varvalue", "payload",     "reading",
                                                       "valore", "message", "vvalue",   "numericvalue"};
constexpr std::array<std::string_view, 7> quality_words{"quality",   "status",        "statuscode",  "validity",
                                                        "qualitaet", "qualit\u00e4t", "quality code"};

std::string word_letters(std::string_view name) {
  std::string out;
  for (const char c : in_small_letters(without_brackets(name)))
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80) out += c;
  return out;
}

template <std::size_t n> bool is_word_of(const std::array<std::string_view, n>& words, const std::string& name) {
  return std::find(words.begin(), words.end(), name) != words.end();
}

/// What stands in one field of all rows of a sample.
struct FieldFacts {
  std::string name;  ///< small letters
  std::size_t numbers = 0, clocks = 0, empty = 0, texts = 0, changes = 0, back = 0, falls = 0;
  std::set<std::string> different;

  bool is_number(std::size_t rows) const { return numbers > 0 && 10 * (numbers + empty) >= 9 * rows; }
  bool is_clock(std::size_t rows) const { return 10 * clocks >= 9 * rows; }
  bool is_text(std::size_t rows) const { return 10 * texts >= 9 * rows; }
  bool repeats(std::size_t rows) const { return 2 * different.size() <= rows; }
};

/// A number as it stands, with its unit behind it, or a truth value.
bool long_value_in(std::string_view field, char decimal, double& value) {
  if (number_in(field, decimal, value) || number_in(trimmed(field.substr(0, unit_start(field))), decimal, value))
    return true;
  const std::string word = in_small_letters(field);
  value = word == "true" ? 1 : 0;
  return word == "true" || word == "false";
}

/// "(1767434671.001)", as tools of a CAN bus write times.
std::string_view without_round_brackets(std::string_view field) {
  const bool is_so = field.size() > 2 && field.front() == '(' && field.back() == ')';
  return is_so ? field.substr(1, field.size() - 2) : field;
}

using SampledRows = std::vector<std::vector<std::string>>;

std::vector<FieldFacts> field_facts(const SampledRows& rows, char decimal) {
  std::vector<FieldFacts> out(rows.front().size());
  for (std::size_t c = 0; c < out.size(); ++c) {
    FieldFacts& facts = out[c];
    double last = no_value;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const std::string& field = rows[r][c];
      double value = no_value;
      const bool is_number = long_value_in(without_round_brackets(field), decimal, value);
      const std::optional<double> clock = is_number ? std::nullopt : clock_in(field);
      facts.numbers += is_number, facts.clocks += clock.has_value(), facts.empty += field.empty();
      facts.texts += !is_number && !clock && !field.empty();
      facts.changes += r > 0 && field != rows[r - 1][c];
      if (clock) value = *clock;
      facts.back += value <= last, facts.falls += value < last;
      last = value;
      facts.different.insert(field);
    }
  }
  return out;
}

bool is_time_name(const std::string& name) {
  const auto word = column_word(name);
  return word && word->ours == "t_s";
}

/// The field of the times: of those that are clocks, or are named so, the one with most different values. Without names
/// the numbers that go back least.
std::size_t time_field(const std::vector<FieldFacts>& facts, const LongRows& how, std::size_t rows) {
  std::size_t out = LongRows::none, most = 0;
  for (std::size_t c = 0; c < facts.size(); ++c) {
    const bool is_named = !how.names.empty() && facts[c].is_number(rows) && is_time_name(how.names[c]);
    if (!(is_named || facts[c].is_clock(rows)) || facts[c].different.size() <= most) continue;
    most = facts[c].different.size();
    out = c;
  }
  if (out != LongRows::none || !how.names.empty()) return out;
  for (std::size_t c = 0; c < facts.size(); ++c)
    if (facts[c].is_number(rows) && facts[c].different.size() > 1 &&
        (out == LongRows::none || facts[c].falls < facts[out].falls))
      out = c;
  return out;
}

/// Fields that name the channel: one whose texts repeat, with another where both together tell more.
std::vector<std::size_t> tag_fields(const std::vector<FieldFacts>& facts, const LongRows& how,
                                    const SampledRows& rows) {
  std::vector<std::size_t> named;
  std::size_t best = LongRows::none;
  for (std::size_t c = 0; c < facts.size(); ++c) {
    const bool is_other = c == how.time || c == how.unit || c == how.quality || how.has_value(c);
    if (is_other || !facts[c].repeats(rows.size())) continue;
    const bool is_named = is_word_of(tag_words, facts[c].name);
    const bool may_be = facts[c].is_text(rows.size()) || (is_named && how.values.size() == 1);
    if (!may_be || (!how.names.empty() && !is_named && how.values.size() == 1)) continue;
    // Numbers between other separators, cut at their decimal commas, name nothing.
    if (std::ranges::all_of(facts[c].different, [](const std::string& text) {
          return text.find_first_of(";\t") != std::string::npos &&
                 text.find_first_not_of("0123456789.+-;\t ") == std::string::npos;
        }))
      continue;
    named.push_back(c);
    if (best == LongRows::none || facts[c].different.size() > facts[best].different.size()) best = c;
  }
  if (named.size() < 2) return named;
  std::erase_if(named, [&](std::size_t c) { return facts[c].different.size() < 2; });
  std::set<std::string> together;
  for (const auto& row : rows) {
    std::string all;
    for (const std::size_t c : named) (all += row[c]) += '\n';
    together.insert(all);
  }
  return together.size() > facts[best].different.size() ? named : std::vector{best};
}

/// Names of the first line, where none of them is a value.
std::vector<std::string> names_of_first(const std::vector<std::string>& fields, const FieldStyle& style) {
  const bool has_values = std::any_of(fields.begin(), fields.end(), [&](const std::string& field) {
    double value = 0;
    return long_value_in(field, style.decimal, value) || clock_in(field).has_value();
  });
  return has_values ? std::vector<std::string>() : fields;
}

std::size_t field_with(const std::vector<FieldFacts>& facts, const auto& is_fit) {
  const auto at = std::find_if(facts.begin(), facts.end(), is_fit);
  return at == facts.end() ? LongRows::none : static_cast<std::size_t>(at - facts.begin());
}

/// Of a day alone, beside the times of the day.
std::size_t date_field(const std::vector<FieldFacts>& facts, std::size_t time, std::size_t rows) {
  constexpr double whole_day_s = 86400;
  const auto is_day = [&](std::size_t c, bool wanted) {
    return std::all_of(facts[c].different.begin(), facts[c].different.end(), [&](const std::string& text) {
      const auto seconds = clock_in(text);
      return !seconds ||
             (wanted ? std::fmod(*seconds, whole_day_s) == 0 && *seconds >= whole_day_s : *seconds < whole_day_s);
    });
  };
  for (std::size_t c = 0; c < facts.size(); ++c)
    if (c != time && facts[c].is_clock(rows) && facts[time].is_clock(rows) && is_day(c, true) && is_day(time, false))
      return c;
  return LongRows::none;
}

/// Fields of numbers beside the times that have more than one value.
std::vector<std::size_t> fields_of_values(const std::vector<FieldFacts>& facts, std::size_t time, std::size_t rows) {
  std::vector<std::size_t> out;
  for (std::size_t c = 0; c < facts.size(); ++c)
    if (c != time && facts[c].is_number(rows) && facts[c].different.size() > 1) out.push_back(c);
  return out;
}

/// Whether each time is there once for each text: rows of several channels, such as axes, with the same values each.
bool share_times(const FieldFacts& tag, const FieldFacts& time, std::size_t rows) {
  const std::size_t expected = tag.different.size() * time.different.size();
  return tag.different.size() > 1 && 10 * expected >= 9 * rows && 10 * expected <= 11 * rows;
}

/// Whether the channels alternate, or each has a course of its own: in tables with a column of states none does.
bool channels_alternate(const FieldFacts& tag, const FieldFacts& time, std::size_t rows) {
  return tag.different.size() > 1 && (2 * tag.changes >= rows || (time.back > 0 && 2 * time.back >= tag.changes));
}

/// The rows below the names, of the usual number of fields; none where other lines are too many.
SampledRows sampled_rows(const std::vector<std::string>& lines, LongRows& out) {
  std::map<std::size_t, std::size_t> counts;
  SampledRows all, rows;
  std::vector<std::string_view> fields;
  for (const std::string& line : lines) {
    split_fields(line, out.style, fields);
    all.emplace_back(fields.begin(), fields.end());
    ++counts[fields.size()];
  }
  const auto is_rarer = [](const auto& a, const auto& b) { return a.second < b.second; };
  const std::size_t count = std::max_element(counts.begin(), counts.end(), is_rarer)->first;
  if (count < 3 || count > most_fields) return {};
  const auto is_usual = [&](const auto& one) { return one.size() == count; };
  const auto first = static_cast<std::size_t>(std::find_if(all.begin(), all.end(), is_usual) - all.begin());
  out.names = names_of_first(all[first], out.style);
  out.first_row = first + (out.names.empty() ? 0 : 1);
  for (std::size_t i = out.first_row; i < all.size(); ++i)
    if (all[i].size() == count && (out.names.empty() || all[i] != out.names)) rows.push_back(all[i]);
  const bool are_most =
      static_cast<double>(rows.size()) >= share_of_rows * static_cast<double>(all.size() - out.first_row);
  return rows.size() >= least_long_rows && are_most ? rows : SampledRows();
}

constexpr std::uint64_t least_good_bits = 192, bits_of_quality = 0xc0, bad_status = 0x80000000;

/// A quality that is a number, decimal or hexadecimal; 0 where it is none.
std::uint64_t quality_number(std::string_view text) {
  double value = 0;
  const bool is_number = hexadecimal_in(text, value) || number_in(text, '.', value);
  constexpr double most = 4294967295.0;
  return is_number && value >= 0 && value <= most ? static_cast<std::uint64_t>(value) : 0;
}

/// Units and quality; of rows without names a text that is a unit throughout.
void take_unit_fields(const std::vector<FieldFacts>& facts, std::size_t rows, LongRows& out) {
  out.unit = field_with(facts, [&](const FieldFacts& one) { return is_unit_word(one.name) && one.repeats(rows); });
  out.quality = field_with(
      facts, [&](const FieldFacts& one) { return is_word_of(quality_words, one.name) && one.repeats(rows); });
  if (out.quality != LongRows::none)
    out.has_bits_of_quality =
        std::any_of(facts[out.quality].different.begin(), facts[out.quality].different.end(),
                    [](const std::string& text) { return quality_number(text) / least_good_bits == 1; });
  for (std::size_t c = 0; c < facts.size() && out.names.empty(); ++c)
    if (facts[c].is_text(rows) && std::all_of(facts[c].different.begin(), facts[c].different.end(),
                                              [](const std::string& text) { return unit_in(text).has_value(); }))
      out.unit = c;
}

LongRows long_rows_in(const std::vector<std::string>& lines, const FieldStyle& style) {
  LongRows out;
  out.style = style;
  const SampledRows rows = sampled_rows(lines, out);
  if (rows.empty()) return {};
  const std::size_t n = rows.size();
  std::vector<FieldFacts> facts = field_facts(rows, style.decimal);
  for (std::size_t c = 0; c < out.names.size(); ++c) facts[c].name = word_letters(out.names[c]);
  out.time = time_field(facts, out, n);
  if (out.time == LongRows::none) return {};
  const FieldFacts& time = facts[out.time];
  take_unit_fields(facts, n, out);
  const std::size_t named = field_with(facts, [&](const FieldFacts& one) {
    return is_word_of(value_words, one.name) && one.is_number(n) && &one != &time;
  });
  const bool is_named = named != LongRows::none;
  out.values = is_named ? std::vector{named} : fields_of_values(facts, out.time, n);
  if (out.values.empty()) return {};
  out.tags = tag_fields(facts, out, rows);
  if (out.tags.empty() || (out.names.empty() && out.tags.size() > 1)) return {};
  const FieldFacts& tag = facts[out.tags.front()];
  if (out.values.size() > 1 && (out.tags.size() > 1 || !tag.is_text(n) || !share_times(tag, time, n))) return {};
  if (!is_named && !channels_alternate(tag, time, n)) return {};
  out.date = date_field(facts, out.time, n);
  out.fields = facts.size();
  return out;
}

}  // namespace

std::string LongRows::name_of(std::size_t field) const {
  return names.empty() || names[field].empty() ? fmt::format("column {}", field + 1) : names[field];
}

LongRows find_long_rows(const std::vector<std::string>& lines) {
  for (const char separator : {',', ';', '\t', '|', ' '})
    for (const char decimal : {'.', ','}) {
      if (separator == ',' && decimal == ',') continue;
      const LongRows found = long_rows_in(lines, {separator, decimal, false});
      if (found.found()) return found;
    }
  return {};
}

bool LongTable::take_time(double& time) {
  const std::string_view field = without_round_brackets(fields_[how_.time]);
  const std::optional<double> clock = clock_in(field);
  if (!clock) return number_in(field, how_.style.decimal, time) || number_in(field, '.', time);
  is_clock_ = true;
  time = *clock;
  if (how_.date == LongRows::none) return true;
  const std::optional<double> day_s = clock_in(fields_[how_.date]);
  time += day_s.value_or(0);
  return day_s.has_value();
}

bool LongRows::has_value(std::size_t field) const {
  return std::find(values.begin(), values.end(), field) != values.end();
}

/// A word, a status code of OPC UA whose first bit says bad, or a quality of OPC whose upper two bits are none.
bool LongTable::is_bad() const {
  if (how_.quality == LongRows::none || fields_[how_.quality].empty()) return false;
  const std::string_view text = fields_[how_.quality];
  const std::uint64_t number = quality_number(text);
  double value = 0;
  const bool has_no_bits = how_.has_bits_of_quality && number_in(text, '.', value) && (number & bits_of_quality) == 0;
  const std::string word = in_small_letters(text);
  const bool is_word = word.starts_with("bad") || word == "error" || word == "invalid";
  return is_word || (number & bad_status) != 0 || has_no_bits;
}

bool LongTable::take_unit(std::string_view unit, std::string& of, double& value) {
  if (unit.empty() || unit == of) return true;
  if (of.empty()) return of = unit, true;
  if (const std::optional<double> factor = factor_between(unit, of)) {
    converted_ += *factor != 1;
    value *= *factor;
    return true;
  }
  if (other_units_++ == 0) first_other_unit_ = fmt::format("{} of {} where {} stood before", shown(unit), tag_, of);
  return false;
}

bool LongTable::take_value(std::size_t of, double& value) {
  const std::string_view field = fields_[of];
  if (is_bad()) {
    ++bad_;
    return false;
  }
  if (field.empty()) return false;
  if (long_value_in(field, how_.style.decimal, value)) return std::isfinite(value);
  if (unreadable_++ == 0) first_unreadable_ = shown(field);
  return false;
}

/// The channel that the row names; "ns=2;s=Axis.Position" is Axis.Position.
TimedGroup& LongTable::channel() {
  tag_.clear();
  for (const std::size_t field : how_.tags) {
    std::string_view text = fields_[field];
    if (const std::size_t at = text.find(";s="); text.starts_with("ns=") && at != std::string_view::npos)
      text.remove_prefix(at + 3);
    if (!tag_.empty()) tag_ += '/';
    tag_ += text;
  }
  const auto found = places_.find(tag_);
  if (found != places_.end()) return channels_[found->second];
  places_.emplace(tag_, channels_.size());
  double number = 0;
  const bool is_number = number_in(tag_, '.', number);
  channels_.emplace_back();
  for (const std::size_t value : how_.values) {
    const std::string name = is_number ? fmt::format("channel {}", tag_) : tag_;
    channels_.back().names.push_back(how_.values.size() > 1 ? name + "/" + how_.name_of(value) : name);
    channels_.back().units.emplace_back();
    channels_.back().values.emplace_back();
  }
  return channels_.back();
}

void LongTable::add(std::string_view line, std::size_t number) {
  if (trimmed(line).empty()) return;
  split_fields(line, how_.style, fields_);
  if (!how_.names.empty() && std::equal(fields_.begin(), fields_.end(), how_.names.begin(), how_.names.end())) return;
  if (fields_.size() != how_.fields) {
    if (!line.starts_with('#'))
      table_.report(number, ProblemKind::field_count,
                    fmt::format("{} fields where {} are expected; the row is not used", fields_.size(), how_.fields));
    return;
  }
  double time = no_value;
  if (!take_time(time)) {
    if (untimed_++ == 0)
      table_.report(number, ProblemKind::no_time,
                    fmt::format("{} is \"{}\", which is no time", how_.name_of(how_.time), shown(fields_[how_.time])));
    return;
  }
  TimedGroup& of = channel();
  std::vector<double> values(how_.values.size(), no_value);
  bool is_there = false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string_view field = fields_[how_.values[i]];
    const bool has_unit_field = how_.unit != LongRows::none && i == 0;
    const std::string_view unit = has_unit_field ? fields_[how_.unit] : field.substr(unit_start(field));
    const bool is_value = take_value(how_.values[i], values[i]) && take_unit(unit, of.units[i], values[i]);
    if (!is_value) values[i] = no_value;
    is_there = is_there || is_value;
  }
  if (!is_there) return;
  refuse_beyond(most_bytes_, (2 + values.size()) * sizeof(double) * ++rows_, table_.path, number);
  of.times.push_back(time);
  of.lines.push_back(number);
  for (std::size_t i = 0; i < values.size(); ++i) of.values[i].push_back(values[i]);
}

/// SampledRows of a channel, most of which stand in order, may hold several runs; others are sorted.
void LongTable::finish() {
  std::size_t rows = 0;
  std::erase_if(channels_, [](const TimedGroup& channel) { return channel.times.empty(); });
  for (TimedGroup& channel : channels_) {
    rows += channel.times.size();
    std::size_t back = 0;
    for (std::size_t i = 1; i < channel.times.size(); ++i) back += channel.times[i] < channel.times[i - 1];
    out_of_order_ += back;
    if (10 * back > channel.times.size()) sort_by_time(channel);
  }
  if (rows == 0)
    throw InputError(fmt::format("{}: there is no row with a time and a value of a channel; expected rows such as {}",
                                 table_.path, names_text(how_.names)));
  table_.names = {how_.names.empty() ? "Timestamp" : how_.name_of(how_.time)};
  table_.units = {""};
  table_.is_clock = {static_cast<char>(is_clock_)};
  tell(rows);
  join_groups(table_, std::move(channels_));
}

void LongTable::tell(std::size_t rows) const {
  std::string tags, value_names;
  for (const std::size_t value : how_.values) value_names += (value_names.empty() ? "" : " and ") + how_.name_of(value);
  for (const std::size_t tag : how_.tags) tags += (tags.empty() ? "" : " and ") + how_.name_of(tag);
  table_.report(
      0, ProblemKind::dialect,
      fmt::format("a long table: {} rows with a value each in {}, of {} channel{} by {}, at the times in {}{}", rows,
                  value_names, channels_.size(), channels_.size() == 1 ? "" : "s", tags, how_.name_of(how_.time),
                  how_.unit == LongRows::none ? "" : ", units from " + how_.name_of(how_.unit)));
  if (out_of_order_ > 0)
    table_.report(0, ProblemKind::decreasing_time,
                  fmt::format("{} rows are earlier than the one before of their channel: put in order", out_of_order_));
  if (converted_ > 0)
    table_.report(
        0, ProblemKind::dialect,
        fmt::format("{} values are in another unit than the first of their channel: brought to that one", converted_));
  if (other_units_ > 0)
    table_.report(0, ProblemKind::unreadable_field,
                  fmt::format("{} values are in a unit of another quantity, such as {}; they are left out",
                              other_units_, first_other_unit_));
  if (bad_ > 0)
    table_.report(0, ProblemKind::not_a_number,
                  fmt::format("{} rows say bad in {}: read as no value", bad_, how_.name_of(how_.quality)));
  if (unreadable_ > 0)
    table_.report(
        0, ProblemKind::unreadable_field,
        fmt::format("{} values are no number, such as \"{}\"; they are left out", unreadable_, first_unreadable_));
  if (untimed_ > 1)
    table_.report(0, ProblemKind::no_time, fmt::format("{} rows have no time; they are not used", untimed_));
}

}  // namespace pneuservo
