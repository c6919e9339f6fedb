// How a foreign table is written, found from its first lines.
#include "record/dialect.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "record/clock_text.hpp"
#include "record/column_guess.hpp"
#include "record/units.hpp"

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

/// What a line holds in a style.
struct LineFacts {
  std::size_t fields = 0, numbers = 0, empty = 0, filled = 0;  ///< filled: without empty ones at the end
  std::vector<char> is_text;  ///< of each field
  bool has_decimals = false;  ///< a number shows the decimal sign
  bool has_label() const { return !is_text.empty() && is_text.front() != 0; }
  /// More than half numbers or gaps, or two numbers of which one is the first.
  bool is_row() const { return numbers > 0 && (2 * (numbers + empty) > fields || (numbers > 1 && !has_label())); }
};

bool is_value(std::string_view field, const FieldStyle& style) {
  double value = 0;
  return number_in(field, style.decimal, value) || clock_in(field) || hexadecimal_in(field, value) ||
         number_in(trimmed(field.substr(0, unit_start(field))), style.decimal, value) ||
         (style.has_groups && number_with_groups(field, style.decimal, value));
}

LineFacts facts_of(std::string_view line, const FieldStyle& style) {
  std::vector<std::string_view> fields;
  split_fields(line, style, fields);
  LineFacts facts;
  facts.fields = fields.size();
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const bool is_number = is_value(fields[i], style);
    facts.empty += fields[i].empty();
    facts.numbers += is_number;
    double value = 0;
    facts.has_decimals = facts.has_decimals || (fields[i].find(style.decimal) != std::string_view::npos &&
                                                number_in(fields[i], style.decimal, value));
    facts.is_text.push_back(!is_number && !fields[i].empty());
    if (!fields[i].empty()) facts.filled = i + 1;
  }
  return facts;
}

/// The number of fields that most rows have; 0 where there is no row.
std::size_t usual_fields(const std::vector<LineFacts>& facts) {
  std::map<std::size_t, std::size_t> counts;
  for (const LineFacts& line : facts)
    if (line.is_row()) ++counts[line.fields];
  std::size_t usual = 0, most = 0;
  for (const auto& [fields, count] : counts)
    if (count >= most) usual = fields, most = count;
  return usual;
}

/// Empty fields at the ends of rows that have more of them than others are none: "1,2,," and "1,2," beside "1,2".
void even_ends(std::vector<LineFacts>& facts) {
  std::size_t most = 0, fewest = std::numeric_limits<std::size_t>::max();
  for (const LineFacts& line : facts) {
    if (!line.is_row()) continue;
    most = std::max(most, line.filled);
    fewest = std::min(fewest, line.fields);
  }
  for (LineFacts& line : facts) {
    if (!line.is_row() || line.fields <= most || fewest > most) continue;
    line.empty -= line.fields - most;
    line.fields = most;
    line.is_text.resize(most);
  }
}

std::vector<LineFacts> all_facts(const std::vector<std::string>& lines, const FieldStyle& style) {
  std::vector<LineFacts> facts;
  facts.reserve(lines.size());
  for (const std::string& line : lines) facts.push_back(facts_of(line, style));
  even_ends(facts);
  return facts;
}

/// The first row: of the usual number of fields, and labelled as most rows are, for lines of a logger's head such as
/// "Samples,3000,3000" look like rows else. The lines' number where there is none.
std::size_t first_row(const std::vector<LineFacts>& facts, std::size_t fields) {
  std::size_t labelled = 0, rows = 0;
  for (const LineFacts& line : facts)
    if (line.is_row() && line.fields == fields) labelled += line.has_label(), ++rows;
  const auto at = std::find_if(facts.begin(), facts.end(), [&](const LineFacts& line) {
    return line.is_row() && line.fields == fields && (!line.has_label() || 2 * labelled > rows);
  });
  return static_cast<std::size_t>(at - facts.begin());
}

/// Of the rows, fields that are numbers less what is neither number nor empty: cutting at the wrong place makes both.
/// Ties are decided by a line above with as many fields, or one right above with more, which names them, then by fewer
/// columns of text.
double score(const std::vector<LineFacts>& facts, char separator) {
  constexpr double stray_cost = 2, text_cost = 1e-6, names_gain = 0.5;
  const std::size_t usual = usual_fields(facts);
  std::vector<double> text(usual);
  const std::size_t first = first_row(facts, usual);
  double rows = 0, sum = 0;
  for (std::size_t i = first; i < facts.size(); ++i) {
    const LineFacts& line = facts[i];
    if (!line.is_row() || line.fields != usual) continue;
    ++rows;
    sum += static_cast<double>(line.numbers);
    for (std::size_t c = 0; c < usual; ++c) text[c] += line.is_text[c];
  }
  const bool is_longer_above =
      separator != ' ' && usual > 1 && first > 0 && facts[first - 1].numbers == 0 && facts[first - 1].fields > usual;
  const bool is_named = std::any_of(facts.begin(), facts.begin() + static_cast<std::ptrdiff_t>(first),
                                    [&](const LineFacts& line) { return line.fields == usual; });
  sum += is_named || is_longer_above ? names_gain : 0;
  for (const double count : text) sum -= (2 * count > rows ? text_cost : stray_cost) * count;
  return sum;
}

/// Whether rows hold values alone: dates of several words between tabs would be cut into more numbers by blanks.
bool are_values_alone(const std::vector<LineFacts>& facts) {
  const std::size_t usual = usual_fields(facts);
  return usual > 1 && std::all_of(facts.begin(), facts.end(), [&](const LineFacts& line) {
           return !line.is_row() || line.fields != usual ||
                  std::find(line.is_text.begin(), line.is_text.end(), 1) == line.is_text.end();
         });
}

std::vector<std::string> names_in(const std::string& line, const FieldStyle& style) {
  std::vector<std::string_view> fields;
  split_fields(line, {style.separator, style.decimal, false}, fields);
  return {fields.begin(), fields.end()};
}

bool is_units_row(const std::vector<std::string>& fields) {
  std::size_t known = 0, filled = 0;
  for (const std::string& field : fields) {
    filled += !field.empty();
    known += !field.empty() && unit_in(field).has_value();
  }
  return filled > 0 && 2 * known > filled;
}

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

/// "double,double,int", "f8,f8,u16": what some exports write below the names.
bool is_types_row(const std::vector<std::string>& fields) {
  constexpr std::array<std::string_view, 23> types{"double",  "float",   "single", "int",    "uint",  "sint",
                                                   "usint",   "dint",    "udint",  "lint",   "ulint", "integer",
                                                   "real",    "lreal",   "bool",   "byte",   "word",  "dword",
                                                   "numeric", "boolean", "string", "number", "long"};
  constexpr std::string_view letters_with_size = "fiub";  // f8, u16
  std::size_t filled = 0;
  for (const std::string& field : fields) {
    std::string letters = in_small_letters(field);
    while (!letters.empty() && std::isdigit(static_cast<unsigned char>(letters.back())) != 0) letters.pop_back();
    const bool is_sized = letters.size() == 1 && letters.size() < field.size() &&
                          letters_with_size.find(letters) != std::string_view::npos;
    if (!field.empty() && !is_sized && std::find(types.begin(), types.end(), letters) == types.end()) return false;
    filled += !field.empty();
  }
  return filled > 0;
}

/// "-----|-----" and the like: drawn, not written.
bool is_ruled(const std::vector<std::string>& fields) {
  return std::all_of(fields.begin(), fields.end(),
                     [](const std::string& field) { return field.find_first_not_of("-=+:_") == std::string::npos; });
}

/// Units of the times of several columns, such as "HUnit,s,s": not those of their values.
bool are_all_times(const std::vector<std::string>& fields) {
  std::size_t times = 0, others = 0;
  for (const std::string& field : fields)
    if (const std::optional<Unit> unit = unit_in(field)) ++(unit->quantity == Quantity::time ? times : others);
  return times > 1 && others == 0 && is_units_row(fields);
}

/// "length=3000", "Serno: 2", "sample rate = 1000 Hz" in each field: what is known of a channel, not its name.
bool states_values(const std::vector<std::string>& fields, const FieldStyle& style) {
  return std::all_of(fields.begin(), fields.end(), [&style](const std::string& field) {
    const std::size_t sign = field.find_first_of("=:");
    return sign != std::string::npos && sign > 0 && is_value(trimmed(std::string_view(field).substr(sign + 1)), style);
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

/// Fields of a line above the rows, without the semicolon that marks a comment before names between semicolons.
std::vector<std::string> head_fields(const std::string& line, const FieldStyle& style, std::size_t fields) {
  std::vector<std::string> out = names_in(line, style);
  if (style.separator == ';' && out.size() == fields + 1 && out.front().empty() && !out.back().empty())
    out.erase(out.begin());
  return out;
}

/// The names in a line above rows between blanks, which may have blanks themselves: two stand between names, or what is
/// in brackets belongs to the one before.
std::vector<std::string> names_with_blanks(const std::string& line, std::size_t fields) {
  std::vector<std::string> far, joined;
  std::string_view rest = trimmed(line);
  while (!rest.empty()) {
    const std::size_t end = std::min({rest.find("  "), rest.find('\t'), rest.size()});
    far.emplace_back(trimmed(rest.substr(0, end)));
    rest = trimmed(rest.substr(end));
  }
  if (far.size() == fields) return far;
  for (const std::string& name : names_in(line, {' ', '.', false})) {
    const bool is_in_brackets = name.starts_with('[') || name.starts_with('(');
    if (is_in_brackets && !joined.empty()) (joined.back() += ' ') += name;
    else joined.push_back(name);
  }
  return joined;
}

/// What a line above the rows can be.
enum class HeadLine { other, names, longer, units, types, ruled, stated };

HeadLine judge_head_line(std::vector<std::string>& here, const std::string& line, std::size_t fields,
                         const Dialect& dialect) {
  if (dialect.style.separator == ' ' && here.size() > fields) {
    std::vector<std::string> joined = names_with_blanks(line, fields);
    if (joined.size() == fields) here = std::move(joined);
  }
  std::size_t filled = 0;
  for (const std::string& field : here) filled += !field.empty();
  if (filled > 0 && is_ruled(here)) return HeadLine::ruled;
  if (3 * filled <= here.size()) return HeadLine::other;  // labels of a head
  const bool matches = here.size() == fields || here.size() + 1 == fields || 2 * here.size() == fields;
  if (!matches) return here.size() > fields && dialect.style.separator != ' ' ? HeadLine::longer : HeadLine::other;
  if (states_values(here, dialect.style)) return HeadLine::stated;
  if (is_types_row(here)) return HeadLine::types;
  if (are_all_times(here)) return HeadLine::stated;
  return is_units_row(here) ? HeadLine::units : HeadLine::names;
}

bool is_unit_label(const std::vector<std::string>& fields) {
  return !fields.empty() && in_small_letters(fields[0]).find("unit") != std::string::npos;
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

/// The line of names above the first row: the nearest whose fields are those of the rows, or one fewer where the rows
/// have an index or a trailing separator; else one with more, where rows leave out what is empty at their end. Rows of
/// units, of types and drawn lines may stand between.
void take_names(const std::vector<std::string>& lines, const std::vector<LineFacts>& facts, std::size_t fields,
                Dialect& out) {
  if (take_labelled(lines, fields, out)) return;
  std::size_t at = lines.size(), nearest = lines.size(), longer = lines.size();
  for (std::size_t i = out.first_row; i-- > 0 && at == lines.size();) {
    std::vector<std::string> here = head_fields(lines[i], out.style, fields);
    const HeadLine kind = judge_head_line(here, lines[i], fields, out);
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
  out.has_pairs = take_repeated_times(out.names);
  take_units_elsewhere(lines, out);
}

/// Units that stand behind the values of the first row, for columns whose unit is not stated otherwise.
void take_value_units(const std::string& row, Dialect& out) {
  std::vector<std::string_view> fields;
  split_fields(row, out.style, fields);
  const std::size_t index = out.has_index ? 1 : 0;
  out.value_units.resize(out.names.size());
  out.units.resize(out.names.size());
  for (std::size_t c = 0; c < out.names.size() && c + index < fields.size(); ++c) {
    const std::string_view field = fields[c + index];
    if (clock_in(field)) continue;
    out.value_units[c] = field.substr(unit_start(field));
    if (out.units[c].empty()) out.units[c] = out.value_units[c];
  }
}

/// "10:11:12,345" between commas: the decimals of the first field's time became the second field.
bool has_split_times(const std::vector<std::string>& lines, std::size_t first, const FieldStyle& style) {
  constexpr std::size_t milliseconds = 3, microseconds = 6;
  return std::all_of(lines.begin() + static_cast<std::ptrdiff_t>(first), lines.end(), [&](const std::string& line) {
    std::vector<std::string_view> fields;
    split_fields(line, style, fields);
    const bool is_digits = fields.size() > 2 && fields[1].find_first_not_of("0123456789") == std::string_view::npos;
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
  if (has_names_below) found.emplace_back("names over two rows");
  if (has_units_row) found.emplace_back("a row of units");
  if (has_split_times) found.emplace_back("decimals of the time behind a comma of their own");
  if (least_fields > 0) found.emplace_back("rows that leave out what is empty at their end");
  if (std::any_of(value_units.begin(), value_units.end(), [](const std::string& unit) { return !unit.empty(); }))
    found.emplace_back("units behind the values");
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
    take_value_units(lines[out.first_row], out);
  }
  out.is_sure = best > 0 && 2 * out.first_row <= lines.size() && shows_decimals(lines, out);
  for (std::size_t i = out.names_line; i < std::min(lines.size(), out.first_row + 1); ++i)
    out.is_quoted = out.is_quoted || lines[i].find('"') != std::string::npos;
  return out;
}

}  // namespace pneuservo
