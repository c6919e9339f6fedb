// How a foreign table is written, found from its first lines.
#include "record/foreign/dialect.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "record/foreign/clock_text.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/foreign/head_line.hpp"
#include "record/foreign/line_facts.hpp"
#include "record/foreign/units.hpp"

namespace pneuservo {

namespace {

/// In the order in which ties are decided: a file of one column reads alike in all.
constexpr std::array<FieldStyle, 10> styles{{{',', '.', false},
                                             {';', '.', false},
                                             {';', ',', false},
                                             {'\t', '.', false},
                                             {'\t', ',', false},
                                             {'|', '.', false},
                                             {'|', ',', false},
                                             {' ', '.', false},
                                             {' ', ',', false},
                                             {',', ',', false}}};  // in quotes

/// Whether the first field of every row counts them up by one.
bool counts_rows(const std::vector<std::string>& lines, std::size_t first, const FieldStyle& style) {
  double last = 0;
  for (std::size_t i = first; i < lines.size(); ++i) {
    std::vector<std::string_view> fields;
    split_fields(lines[i], style, fields);
    double value = 0;
    if (fields.empty() || !number_in(fields[0], '.', value) || value != std::round(value)) return false;
    if (i > first && value != last + 1) return false;
    last = value;
  }
  return lines.size() > first + 1;
}

/// Both signs are commas: every row has twice the fields of the names, and every second is digits alone.
bool is_paired(const std::vector<std::string>& lines, std::size_t first, std::size_t names, const FieldStyle& style) {
  if (style.separator != ',') return false;
  for (std::size_t i = first; i < lines.size(); ++i) {
    std::vector<std::string_view> fields;
    split_fields(lines[i], style, fields);
    if (fields.size() != 2 * names) return false;
    for (std::size_t f = 0; f < fields.size(); ++f)
      if (fields[f].find('.') != std::string_view::npos ||
          (f % 2 == 1 && fields[f].find_first_not_of("0123456789eE+-") != std::string_view::npos))
        return false;
  }
  return true;
}

bool all_end_with(const std::vector<std::string>& lines, std::size_t first, char separator) {
  return separator != ' ' &&
         std::all_of(lines.begin() + static_cast<std::ptrdiff_t>(first), lines.end(), [&](std::string_view line) {
           while (line.ends_with(' ')) line.remove_suffix(1);
           return line.ends_with(separator);
         });
}

/// "Name;Position;Name;Command": each value has a column of times of its own before it.
bool is_labelled(const std::vector<std::string>& fields, std::string_view label) {
  if (fields.size() < 4 || fields.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < fields.size(); i += 2)
    if (fields[i] != label) return false;
  return true;
}

/// Names and units of a head whose lines begin each pair of columns with a label.
bool take_labelled(const std::vector<std::string>& lines, std::size_t fields, Dialect& out) {
  std::string time_unit;
  for (std::size_t i = 0; i < out.first_row; ++i) {
    std::vector<std::string> here = names_in(lines[i], out.style);
    if (here.size() == fields + 1 && here.back().empty()) here.pop_back();
    if (here.size() != fields) continue;
    if (is_labelled(here, "Name")) {
      out.names_line = i;
      out.names = here;
      for (std::size_t c = 0; c < fields; c += 2) out.names[c] = "Time";
      out.has_rows_between = out.has_pairs = true;
    } else if (!out.names.empty() && is_labelled(here, "Unit")) {
      out.units = here;
    } else if (!here.empty() && here[0].starts_with("SampleTime[") && here[0].ends_with(']')) {
      time_unit = here[0].substr(here[0].find('[') + 1);
      time_unit.pop_back();
    }
  }
  if (out.names.empty()) return false;
  out.units.resize(fields);
  for (std::size_t c = 0; c < fields; c += 2) out.units[c] = time_unit;
  return true;
}

/// Units that a line below or above the names states, or one that begins with a label: "Y_Unit_Label;mm;V".
void take_units(std::vector<std::string> here, Dialect& out) {
  if (is_unit_label(here)) here[0].clear();
  out.units = std::move(here);
}

void take_units_elsewhere(const std::vector<std::string>& lines, Dialect& out) {
  for (std::size_t i = 0; i < out.names_line && out.units.empty(); ++i) {
    std::vector<std::string> here = names_in(lines[i], out.style);
    const bool is_labelled = is_unit_label(here);
    if (is_labelled) here[0].clear();
    if (here.size() == out.names.size() && (is_labelled || i + 1 == out.names_line) && is_units_row(here))
      take_units(here, out);
  }
}

/// "Valve Time (ms)" before "Valve Value (V)": "Time (ms)"; empty where it is no name of another's times.
std::string times_of(const std::string& name, const std::string& value_name) {
  const std::size_t unit = std::min(name.find_first_of("[("), name.size());
  const std::string text = in_small_letters(trimmed(std::string_view(name).substr(0, unit)));
  for (const std::string_view word : {"time", "timestamp", "zeit", "t"}) {
    if (text.size() < word.size() + 2 || !text.ends_with(word)) continue;
    const std::string whose = text.substr(0, text.size() - word.size());
    if (std::isalnum(static_cast<unsigned char>(whose.back())) == 0 && in_small_letters(value_name).starts_with(whose))
      return "Time " + name.substr(unit);
  }
  return "";
}

/// Whether every second name is that of the times: pairs of times and values, with a column of remarks at the end or
/// not. Times named after their values are named alike.
bool take_repeated_times(std::vector<std::string>& names) {
  const std::size_t pairs = names.size() / 2;
  if (pairs < 2 || names[0].empty()) return false;
  std::vector<std::string> alike = names;
  for (std::size_t c = 0; c < 2 * pairs; c += 2)
    if (const std::string times = times_of(names[c], names[c + 1]); !times.empty()) alike[c] = trimmed(times);
  for (std::size_t c = 0; c < 2 * pairs; ++c)
    if ((alike[c] == alike[0]) != (c % 2 == 0)) return false;
  names = std::move(alike);
  return true;
}

/// Names between other separators than the rows' fields: as many as there are fields.
void take_names_between_others(const std::string& line, std::size_t fields, Dialect& out) {
  for (const char separator : {';', '\t', ',', '|'}) {
    std::vector<std::string> names = names_in(line, {separator, '.', false});
    const bool is_filled = std::none_of(names.begin(), names.end(), [](const std::string& n) { return n.empty(); });
    if (separator == out.style.separator || names.size() != fields || fields < 2 || !is_filled) continue;
    out.names = std::move(names);
    out.names_separator = separator;
    return;
  }
}

/// The line of names above the first row: the nearest whose fields are those of the rows, or one fewer where the rows
/// have an index or a trailing separator; else one with more, where rows leave out what is empty at their end. Rows of
/// units, of types and drawn lines may stand between.
void take_names(const std::vector<std::string>& lines, const std::vector<LineFacts>& facts, std::size_t fields,
                Dialect& out) {
  if (take_labelled(lines, fields, out)) return;
  std::size_t at = lines.size(), nearest = lines.size(), longer = lines.size();
  for (std::size_t i = out.first_row; i-- > 0 && at == lines.size();) {
    std::vector<std::string> here = head_fields(lines[i], out.style, fields);
    const HeadLine kind = judge_head_line(here, lines[i], fields, out.style);
    if (kind == HeadLine::longer && longer == lines.size() && !facts[i].is_row()) longer = i;
    if (longer == i && facts[i].numbers == 0 && i + 1 == out.first_row) break;  // a last column without values
    const bool is_between = kind == HeadLine::types || kind == HeadLine::ruled || kind == HeadLine::stated ||
                            (kind == HeadLine::units && out.units.empty());
    if (kind == HeadLine::units && is_between) take_units(here, out);
    if (is_between && kind != HeadLine::ruled && kind != HeadLine::stated && nearest == lines.size()) nearest = i;
    if (is_between) out.has_rows_between = true;
    const bool is_named = kind == HeadLine::names && !facts[i].is_row();
    const bool has_numbers = 2 * facts[i].numbers > facts[i].fields - facts[i].empty;  // most names are none
    if (is_named && has_numbers && nearest == lines.size()) nearest = i;
    if ((is_named && !has_numbers) || (kind == HeadLine::units && !is_between && !is_unit_label(here))) at = i;
  }
  if (at == lines.size()) {  // what has no names above it is the names
    out.units.clear();
    out.has_rows_between = false;
    out.least_fields = longer < lines.size() ? fields : 0;
    at = nearest < lines.size() ? nearest : longer < lines.size() ? longer : out.first_row - 1;
  }
  out.names_line = at;
  out.names = head_fields(lines[at], out.style, fields);
  if (out.style.separator == ' ' && out.names.size() > fields) out.names = names_with_blanks(lines[at], fields);
  if (out.names.size() < fields) take_names_between_others(lines[at], fields, out);
  out.has_pairs = take_repeated_times(out.names);
  take_units_elsewhere(lines, out);
}

/// Units that stand behind the values of the first row that has some, for columns whose unit is not stated otherwise.
void take_value_units(const std::vector<std::string>& lines, Dialect& out) {
  std::vector<std::string_view> fields;
  const std::size_t index = out.has_index ? 1 : 0;
  out.value_units.resize(out.names.size());
  out.units.resize(out.names.size());
  std::vector<char> is_seen(out.names.size());
  for (std::size_t i = out.first_row; i < lines.size(); ++i) {
    split_fields(lines[i], out.style, fields);
    if (i > out.first_row && fields.size() != out.names.size() + index) continue;
    for (std::size_t c = 0; c < out.names.size() && c + index < fields.size(); ++c) {
      const std::string_view field = fields[c + index];
      double value = 0;
      if (field.empty() || std::exchange(is_seen[c], 1) != 0) continue;
      if (clock_in(field) || prefixed_number(field, out.style.decimal, value)) continue;
      out.value_units[c] = field.substr(unit_start(field));
      if (out.units[c].empty()) out.units[c] = out.value_units[c];
    }
  }
}

/// Digits behind the decimal sign that nearly all rows show in a field, for what is written otherwise is no row.
void take_decimals(const std::vector<std::string>& lines, Dialect& out) {
  constexpr std::size_t least_alike = 20, most_others = 4;
  std::vector<std::map<int, std::size_t>> counts(out.names.size());
  std::vector<std::string_view> fields;
  const std::size_t index = out.has_index ? 1 : 0;
  for (std::size_t i = out.first_row; i < lines.size(); ++i) {
    split_fields(lines[i], out.style, fields);
    if (fields.size() != counts.size() + index) continue;
    for (std::size_t c = 0; c < counts.size(); ++c)
      if (const int digits = decimals_of(fields[c + index], out.style.decimal); digits >= 0) ++counts[c][digits];
  }
  out.decimals.assign(out.names.size(), -1);
  for (std::size_t c = 0; c < counts.size(); ++c) {
    std::size_t rows = 0;
    for (const auto& [digits, count] : counts[c]) rows += count;
    for (const auto& [digits, count] : counts[c])
      if (count >= least_alike && rows - count <= most_others) out.decimals[c] = digits;
  }
}

/// What the lines above the rows state of the columns' numbers: factors and offsets in a line of its own, or one
/// factor of all as in "1.0e+05 *", which MATLAB writes above a matrix.
void take_factors(const std::vector<std::string>& lines, Dialect& out) {
  for (std::size_t i = 0; i < out.first_row; ++i) {
    const std::string_view line = trimmed(lines[i]);
    double factor = 0;
    if (states_factors(names_in(lines[i], out.style), out.style, out.names.size())) out.scale_line = i;
    const bool is_power = i > out.names_line && line.ends_with('*') && line.find_first_of("eE") != std::string::npos;
    if (!is_power || !number_in(trimmed(line.substr(0, line.size() - 1)), '.', factor)) continue;
    out.factor = factor;
    out.has_rows_between = true;
  }
}

/// "10:11:12,345" between commas: the decimals of the first field's time became the second field.
bool has_split_times(const std::vector<std::string>& lines, std::size_t first, const FieldStyle& style) {
  constexpr std::size_t milliseconds = 3, microseconds = 6;
  return std::all_of(lines.begin() + static_cast<std::ptrdiff_t>(first), lines.end(), [&](const std::string& line) {
    std::vector<std::string_view> fields;
    split_fields(line, style, fields);
    const bool is_digits = fields.size() > 2 && are_digits(fields[1]);
    return is_digits && (fields[1].size() == milliseconds || fields[1].size() == microseconds) && clock_in(fields[0]);
  });
}

void take_edges(const std::vector<std::string>& lines, std::size_t fields, Dialect& out) {
  if (out.names.size() * 2 == fields && is_paired(lines, out.first_row, out.names.size(), out.style)) {
    out.style = {',', ',', true};
    return;
  }
  if (fields > 1 && all_end_with(lines, out.first_row, out.style.separator)) {
    out.has_trailing = true;
    if (out.names.size() == fields && out.names.back().empty()) out.names.pop_back();
    --fields;
  }
  const bool lacks_name = out.names.size() + 1 == fields;
  out.has_split_times = lacks_name && out.style.separator == ',' && has_split_times(lines, out.first_row, out.style);
  const bool is_nameless = out.names.size() == fields && fields > 1 &&
                           (out.names[0].empty() || out.names[0] == "Unnamed: 0" || out.names[0] == "index");
  if ((lacks_name || is_nameless) && counts_rows(lines, out.first_row, out.style)) {
    out.has_index = true;
    if (is_nameless) {
      out.names.erase(out.names.begin());
      if (!out.units.empty()) out.units.erase(out.units.begin());
    }
  }
}

/// Names in a line beside that of the names, as many as there are columns; empty where it holds something else.
std::vector<std::string> names_beside(const std::string& line, const Dialect& dialect) {
  std::vector<std::string> out = names_in(line, dialect.style);
  if (dialect.has_index && out.size() == dialect.names.size() + 1) out.erase(out.begin());
  if (out.size() == dialect.names.size() + 1 && out.back().empty()) out.pop_back();
  if (dialect.style.separator == ' ' || out.size() < 2 || out.size() > dialect.names.size()) return {};
  if (is_types_row(out) || is_ruled(out) || is_unit_label(out) || states_values(out, dialect.style)) return {};
  if (const std::string label = common_label(out); !label.empty() && label.find("name") == std::string::npos) return {};
  out.resize(dialect.names.size());
  return out;
}

/// "Pressure [bar]" above "A": "Pressure A [bar]".
std::string joined_name(const std::string& above, const std::string& below) {
  if (above.empty() || below.empty() || above == below) return above.empty() ? below : above;
  const std::size_t unit = std::min(above.find_first_of("[("), above.size());
  const std::string before(trimmed(std::string_view(above).substr(0, unit)));
  return before + " " + below + (unit < above.size() ? " " + above.substr(unit) : "");
}

/// Names over two lines: an upper one stands for the columns up to the next. Taken where more columns are known by
/// both together than by the lower ones alone; what is known alone keeps its name.
bool join_names(const std::vector<std::string>& upper, const std::vector<std::string>& lower, Dialect& out) {
  std::vector<std::string> joined = lower;
  std::string group;
  std::set<std::string> known;
  for (const std::string& name : lower) known.insert(meaning_of(name));
  bool tells_more = false;
  for (std::size_t c = 0; c < lower.size(); ++c) {
    const std::string alone = meaning_of(lower[c]);
    if (!upper[c].empty()) group = upper[c];
    else if (!alone.empty()) group.clear();
    if (!alone.empty() || group.empty()) continue;
    joined[c] = joined_name(group, lower[c]);
    const std::string both = meaning_of(joined[c]);
    tells_more = tells_more || (!lower[c].empty() && !both.empty() && known.insert(both).second);
  }
  if (tells_more) out.names = std::move(joined);
  return tells_more;
}

/// A column without a name in the nearest line bears that of the line above, as "Time" above "". Names may go on over
/// two lines.
void fill_names(const std::vector<std::string>& lines, const std::vector<LineFacts>& facts, Dialect& out) {
  const bool has_labels = is_labelled(names_in(lines[out.names_line], out.style), "Name");
  if (!has_labels && out.names_line + 1 < out.first_row && facts[out.names_line + 1].numbers == 0) {
    const std::vector<std::string> below = names_beside(lines[out.names_line + 1], out);
    if (!below.empty() && !is_units_row(below) && join_names(out.names, below, out)) {
      out.has_rows_between = out.has_names_below = true;
      return;
    }
  }
  std::size_t at = out.names_line;
  std::vector<std::string> above;
  while (above.empty() && at > 0 && facts[at - 1].numbers == 0) {  // behind rows of units
    above = names_beside(lines[--at], out);
    const bool is_units = !above.empty() && is_units_row(above);
    if (above.empty() || !is_units) break;
    if (out.units.empty()) out.units = above;
    above.clear();
  }
  if (above.empty()) return;
  out.has_names_below = !has_labels && join_names(above, out.names, out);
  if (out.has_index || out.has_names_below || names_in(lines[at], out.style).size() != out.names.size()) return;
  for (std::size_t c = 0; c < above.size(); ++c)
    if (out.names[c].empty()) out.names[c] = above[c];
}

/// Whether a number of the rows has a decimal sign.
bool shows_decimals(const std::vector<std::string>& lines, const Dialect& dialect) {
  std::vector<std::string_view> fields;
  for (std::size_t i = dialect.first_row; i < lines.size(); ++i) {
    split_fields(lines[i], dialect.style, fields);
    double value = 0;
    for (const std::string_view field : fields)
      if (field.find(dialect.style.decimal) != std::string_view::npos && number_in(field, dialect.style.decimal, value))
        return true;
  }
  return false;
}

}  // namespace

std::string Dialect::words() const {
  std::vector<std::string> found;
  if (style.separator != ',')
    found.push_back(style.separator == '\t'  ? "separator tab"
                    : style.separator == ' ' ? "separator blanks"
                                             : fmt::format("separator {}", style.separator));
  if (style.decimal == ',') found.emplace_back("decimal comma");
  if (is_quoted) found.emplace_back("quotes");
  if (names_line > 0) found.push_back(fmt::format("{} line{} before the names", names_line, names_line > 1 ? "s" : ""));
  if (names_separator != 0)
    found.push_back(fmt::format("names between other separators ({})",
                                names_separator == '\t' ? "tab" : std::string(1, names_separator)));
  if (has_names_below) found.emplace_back("names over two rows");
  if (has_units_row) found.emplace_back("a row of units");
  if (has_split_times) found.emplace_back("decimals of the time behind a comma of their own");
  if (least_fields > 0) found.emplace_back("rows that leave out what is empty at their end");
  if (std::any_of(value_units.begin(), value_units.end(), [](const std::string& unit) { return !unit.empty(); }))
    found.emplace_back("units behind the values");
  if (factor != 1) found.push_back(fmt::format("all values times {:g}, as stated above the rows", factor));
  if (has_index) found.emplace_back("an index column, left out");
  if (has_trailing) found.emplace_back("a separator at the end of each row");
  return fmt::format("{}", fmt::join(found, ", "));
}

Dialect find_dialect(const std::vector<std::string>& lines) {
  Dialect out;
  std::vector<LineFacts> facts;
  double best = 0;
  bool is_whole_by_tabs = false;
  for (FieldStyle style : styles) {
    if (style.separator == ' ' && is_whole_by_tabs) continue;
    std::vector<LineFacts> own = all_facts(lines, style);
    if (style.separator == '\t') is_whole_by_tabs = is_whole_by_tabs || are_values_alone(own);
    style.has_groups = std::any_of(own.begin(), own.end(), [usual = usual_fields(own)](const LineFacts& line) {
      return line.is_row() && line.fields == usual && line.has_decimals;
    });
    if (style.has_groups) own = all_facts(lines, style);
    const double reached = score(own, style.separator);
    if (facts.empty() || reached > best) {
      out.style = style;
      best = reached;
      facts = std::move(own);
    }
  }
  const std::size_t fields = usual_fields(facts);
  out.first_row = first_row(facts, fields);
  out.is_nameless = best > 0 && out.first_row == 0;
  if (best <= 0 || out.first_row == 0 || out.first_row == lines.size()) {
    out.style = {};
    out.first_row = 1;
    out.names = names_in(lines[0], out.style);
  } else {
    take_names(lines, facts, fields, out);
    out.has_units_row = !out.units.empty();
    take_edges(lines, fields, out);
    fill_names(lines, facts, out);
    take_value_units(lines, out);
    take_decimals(lines, out);
    take_factors(lines, out);
  }
  out.is_sure = best > 0 && 2 * out.first_row <= lines.size() && shows_decimals(lines, out);
  for (std::size_t i = out.names_line; i < std::min(lines.size(), out.first_row + 1); ++i)
    out.is_quoted = out.is_quoted || lines[i].find('"') != std::string::npos;
  return out;
}

}  // namespace pneuservo
