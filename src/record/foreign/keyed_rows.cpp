// Rows whose fields bear their names.
#include "record/foreign/keyed_rows.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "record/foreign/column_guess.hpp"
#include "record/foreign/column_words.hpp"
#include "record/foreign/field_text.hpp"
#include "record/foreign/names_text.hpp"
#include "record/foreign/units.hpp"

namespace pneuservo {

namespace {

using PairKind = PairStyle::Kind;

/// A field between commas.
std::string as_field(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  return text.find(',') == std::string::npos ? text : "\"" + text + "\"";
}

bool has_twice(const std::vector<NamedValue>& values) {
  std::set<std::string_view> names;
  return !std::all_of(values.begin(), values.end(),
                      [&](const NamedValue& one) { return names.insert(one.name).second; });
}

/// Split lines may say a name twice: it is numbered then.
void number_repeated(std::vector<NamedValue>& values) {
  std::map<std::string, int> counts;
  for (NamedValue& one : values)
    if (const int count = ++counts[one.name]; count > 1) one.name = fmt::format("{} ({})", one.name, count);
}

std::vector<NamedValue> distinct_values(std::string_view line, const PairStyle& style,
                                        const std::vector<std::string>& known = {}) {
  std::vector<NamedValue> out = values_in(line, style, known);
  if (style.kind == PairKind::split) number_repeated(out);
  return has_twice(out) ? std::vector<NamedValue>() : out;
}

/// What the lines of a sample say of one name.
struct NameFacts {
  std::string name, unit;
  std::size_t values = 0;
  bool has_other_unit = false;  ///< one of another quantity
};

void note_unit(const std::string& unit, NameFacts& facts) {
  if (unit.empty()) return;
  if (facts.unit.empty()) facts.unit = unit;
  const std::optional<Unit> one = unit_in(facts.unit), other = unit_in(unit);
  facts.has_other_unit = facts.has_other_unit || !one || !other || one->quantity != other->quantity;
}

/// The names of lines, two of which nine lines in ten hold: others may be missing at times. A name in one line of a
/// hundred is a remark; where names hold for less than half of the lines on the average, each line speaks of something
/// else, as those of a head do.
KeyedRows keyed_rows_in(const std::vector<std::string>& lines, const PairStyle& style) {
  constexpr std::size_t most_lines_a_name = 100;
  if (distinct_values(lines.back(), style).empty() && style.kind == PairKind::split) return {};
  std::vector<NameFacts> facts;
  std::map<std::string, std::size_t> places;
  std::size_t common = 0, values = 0;
  for (const std::string& line : lines) {
    const std::vector<NamedValue> found = distinct_values(line, style);
    for (const NamedValue& one : found) {
      const auto [at, is_new] = places.emplace(one.name, facts.size());
      if (is_new) facts.push_back({one.name, "", 0, false});
      facts[at->second].values += !one.value.empty();
      note_unit(one.unit, facts[at->second]);
    }
  }
  KeyedRows out;
  out.style = style;
  for (const NameFacts& one : facts) {
    if (one.values == 0 || most_lines_a_name * one.values < lines.size()) continue;
    values += one.values;
    common += 10 * one.values >= 9 * lines.size();
    out.names.push_back(one.name);
    out.units.push_back(one.has_other_unit ? "" : one.unit);
  }
  const std::size_t stamps = style.kind == PairKind::split ? 0 : places.count(std::string(stamp_name));
  const bool is_found = out.names.size() >= 2 + stamps && common > 1 && 2 * values >= lines.size() * out.names.size();
  return is_found ? out : KeyedRows();
}

/// Of the numbers before the first name, the first that goes on and never back; none where a name is a time already.
std::size_t stamp_among_numbers(const std::vector<std::string>& lines, const KeyedRows& how) {
  const bool has_time = std::any_of(how.names.begin(), how.names.end(), [](const std::string& name) {
    return name == stamp_name || meaning_of(name) == "t_s";
  });
  if (has_time || how.names.empty()) return PairStyle::none;
  std::vector<std::vector<LooseNumber>> rows;
  std::size_t count = PairStyle::none;
  for (const std::string& line : lines) {
    if (!how.holds_values(line)) continue;
    rows.push_back(numbers_before_names(line, how.style));
    count = std::min(count, rows.back().size());
  }
  for (std::size_t k = 0; !rows.empty() && k < count; ++k) {
    std::size_t on = 0, back = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      on += rows[i][k].value > rows[i - 1][k].value;
      back += rows[i][k].value < rows[i - 1][k].value;
    }
    if (back == 0 && 2 * on >= rows.size()) return k;
  }
  return PairStyle::none;
}

/// With a decimal comma where values show one and none shows a point.
KeyedRows find_loose_rows(const std::vector<std::string>& lines, PairStyle style) {
  KeyedRows out = keyed_rows_in(lines, style);
  if (style.kind == PairKind::scanned) {
    const auto shows = [&](const PairStyle& how, auto&& is_so) {
      return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
        const std::vector<NamedValue> found = values_in(line, how);
        return std::any_of(found.begin(), found.end(), [&](const NamedValue& one) {
          double value = 0;
          return one.name != stamp_name && number_in(one.value, '.', value) && is_so(one);
        });
      });
    };
    const auto has_point = [](const NamedValue& one) { return one.value.find('.') != std::string::npos; };
    PairStyle comma = style;
    comma.decimal = ',';
    if (!shows(style, has_point) && shows(comma, has_point))
      if (KeyedRows with_comma = keyed_rows_in(lines, comma); with_comma.names.size() >= out.names.size())
        out = std::move(with_comma);
  }
  if (const std::size_t stamp = stamp_among_numbers(lines, out); stamp != PairStyle::none) {
    style = out.style;
    style.stamp = stamp;
    out = keyed_rows_in(lines, style);
  }
  return out;
}

/// One object around all values but those beside it, whose key says nothing of them: {"ts": 1, "data": {"x": 0.5}}.
std::string empty_wrapper(const std::vector<std::string>& names) {
  std::string out;
  std::size_t inside = 0;
  for (const std::string& name : names) {
    const std::size_t point = name.find('.');
    if (point == std::string::npos) continue;
    const std::string here = name.substr(0, point + 1), rest = name.substr(point + 1);
    const bool is_told = !meaning_of(name).empty() && meaning_of(name) != meaning_of(rest);
    const bool is_there = std::find(names.begin(), names.end(), rest) != names.end();
    if ((inside++ > 0 && here != out) || is_told || is_there) return "";
    out = here;
  }
  return inside > 1 && !column_word(out.substr(0, out.size() - 1)) ? out : "";
}

/// A path of keys as a column's name. Words before a point are a place elsewhere, here they may tell a set point from
/// what it is for: then they are words of one name.
std::string column_name(std::string path, const std::string& wrapper) {
  if (!wrapper.empty() && path.starts_with(wrapper)) path.erase(0, wrapper.size());
  std::string words = path;
  std::replace(words.begin(), words.end(), '.', ' ');
  const bool tells_more = meaning_of(words) != meaning_of(path) && (column_word(words) || !meaning_of(words).empty());
  return tells_more ? words : path;
}

/// Of each name, in their order.
std::vector<std::string> column_names(const KeyedRows& how) {
  std::vector<std::string> out = how.names;
  if (how.style.kind != PairKind::object) return out;
  const std::string wrapper = empty_wrapper(how.names);
  for (std::string& name : out) name = column_name(name, wrapper);
  return out;
}

/// The value in a column's unit; with its own behind it where it has another quantity.
std::string value_in_unit(const NamedValue& one, const std::string& unit) {
  if (one.unit.empty() || one.unit == unit) return one.value;
  const std::optional<double> factor = factor_between(one.unit, unit);
  double value = 0;
  if (!factor || !number_in(one.value, '.', value)) return one.value + " " + one.unit;
  return *factor == 1 ? one.value : fmt::format("{}", value * *factor);
}

}  // namespace

std::string KeyedRows::names_line() const {
  std::vector<std::string> fields;
  for (const std::string& name : column_names(*this)) fields.push_back(as_field(name));
  return fmt::format("{}", fmt::join(fields, ","));
}

std::string KeyedRows::row(std::string_view line) {
  std::vector<std::string> values(names.size());
  bool is_there = false;
  for (const NamedValue& one : distinct_values(line, style, names)) {
    const auto at = std::find(names.begin(), names.end(), one.name);
    if (at == names.end()) {
      left_out[one.name] += !one.value.empty();
      continue;
    }
    const auto c = static_cast<std::size_t>(at - names.begin());
    values[c] = as_field(value_in_unit(one, units[c]));
    is_there = true;
  }
  const bool is_bracket = style.kind == PairKind::object && line.find_first_not_of("[], \t") == std::string_view::npos;
  if (!is_there) return is_bracket ? "" : std::string(line);
  return fmt::format("{}", fmt::join(values, ","));
}

bool KeyedRows::holds_values(std::string_view line) const { return !distinct_values(line, style).empty(); }

void KeyedRows::state_units(Dialect& dialect) const {
  dialect.units.resize(dialect.names.size());
  dialect.value_units.resize(dialect.names.size());
  const std::vector<std::string> shown_names = column_names(*this);
  for (std::size_t c = 0; c < dialect.names.size(); ++c) {
    const auto at = std::find(shown_names.begin(), shown_names.end(), dialect.names[c]);
    if (at == shown_names.end() || units[static_cast<std::size_t>(at - shown_names.begin())].empty()) continue;
    dialect.units[c] = dialect.value_units[c] = units[static_cast<std::size_t>(at - shown_names.begin())];
  }
}

void KeyedRows::tell(CsvTable& table) const {
  std::vector<std::string> others;
  std::size_t lines = 0;
  for (const auto& [name, count] : left_out)
    if (count > 0) others.push_back(name), lines = std::max(lines, count);
  if (!names.empty() && style.decimal == ',')
    table.report(0, ProblemKind::dialect, "the values behind the names are read with a decimal comma");
  if (!others.empty())
    table.report(0, ProblemKind::dialect,
                 fmt::format("{} line{} name{} also {}, which the first lines do not, or seldom: left out", lines,
                             lines == 1 ? "" : "s", lines == 1 ? "s" : "", names_text(others)));
}

KeyedRows find_keyed_rows(const std::vector<std::string>& lines) {
  if (KeyedRows found = find_loose_rows(lines, {PairKind::object, ',', ':', '.', PairStyle::none});
      !found.names.empty())
    return found;
  for (const char decimal : {'.', ','})
    for (const char separator : {',', ';', '\t', '|', ' '})
      for (const char sign : {':', '='}) {
        if (separator == ',' && decimal == ',') continue;
        KeyedRows found = keyed_rows_in(lines, {PairKind::split, separator, sign, decimal, PairStyle::none});
        if (!found.names.empty()) return found;
      }
  return find_loose_rows(lines, {PairKind::scanned, ',', '=', '.', PairStyle::none});
}

}  // namespace pneuservo
