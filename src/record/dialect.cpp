// How a foreign table is written, found from its first lines.
#include "record/dialect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "record/clock_text.hpp"
#include "record/units.hpp"

namespace pneuservo {

namespace {

/// In the order in which ties are decided: a file of one column reads alike in all.
constexpr std::array<FieldStyle, 9> styles{{{',', '.', false},
                                            {';', '.', false},
                                            {';', ',', false},
                                            {'\t', '.', false},
                                            {'\t', ',', false},
                                            {'|', '.', false},
                                            {'|', ',', false},
                                            {' ', '.', false},
                                            {' ', ',', false}}};

/// What a line holds in a style.
struct LineFacts {
  std::size_t fields = 0, numbers = 0, empty = 0;
  std::vector<char> is_text;  ///< of each field
  bool has_label() const { return !is_text.empty() && is_text.front() != 0; }
  /// More than half numbers or gaps, or two numbers of which one is the first.
  bool is_row() const { return numbers > 0 && (2 * (numbers + empty) > fields || (numbers > 1 && !has_label())); }
};

bool is_value(std::string_view field, char decimal) {
  double value = 0;
  return number_in(field, decimal, value) || clock_in(field) ||
         number_in(trimmed(field.substr(0, unit_start(field))), decimal, value);
}

LineFacts facts_of(std::string_view line, const FieldStyle& style) {
  std::vector<std::string_view> fields;
  split_fields(line, style, fields);
  LineFacts facts{fields.size(), 0, 0, {}};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const bool is_number = is_value(fields[i], style.decimal);
    facts.empty += fields[i].empty();
    facts.numbers += is_number;
    facts.is_text.push_back(!is_number && !fields[i].empty());
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

std::vector<LineFacts> all_facts(const std::vector<std::string>& lines, const FieldStyle& style) {
  std::vector<LineFacts> facts;
  facts.reserve(lines.size());
  for (const std::string& line : lines) facts.push_back(facts_of(line, style));
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
/// Ties are decided by a line above with as many fields, which names them, then by fewer columns of text.
double score(const std::vector<LineFacts>& facts) {
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
  sum += std::any_of(facts.begin(), facts.begin() + static_cast<std::ptrdiff_t>(first),
                     [&](const LineFacts& line) { return line.fields == usual; })
             ? names_gain
             : 0;
  for (const double count : text) sum -= (2 * count > rows ? text_cost : stray_cost) * count;
  return sum;
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
    known += !field.empty() && unit_in(field) != nullptr;
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

/// "double,double,int": what some exports write below the names.
bool is_types_row(const std::vector<std::string>& fields) {
  constexpr std::array<std::string_view, 14> types{"double", "float",   "float32", "float64", "single",
                                                   "int",    "int32",   "int64",   "integer", "REAL",
                                                   "LREAL",  "numeric", "bool",    "BOOL"};
  return std::all_of(fields.begin(), fields.end(), [&](const std::string& field) {
    return field.empty() || std::find(types.begin(), types.end(), field) != types.end();
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
      for (std::size_t c = 0; c < fields; c += 2) out.units[c].clear();
    }
  }
  return !out.names.empty();
}

/// The line of names above the first row: the nearest whose fields are those of the rows, or one fewer where the rows
/// have an index or a trailing separator. Rows of units and of types may stand between.
void take_names(const std::vector<std::string>& lines, std::size_t fields, Dialect& out) {
  if (take_labelled(lines, fields, out)) return;
  std::size_t at = lines.size(), nearest = lines.size();
  for (std::size_t i = out.first_row; i-- > 0;) {
    const std::vector<std::string> here = names_in(lines[i], out.style);
    const bool matches = here.size() == fields || here.size() + 1 == fields || 2 * here.size() == fields;
    if (!matches) continue;
    if (nearest == lines.size()) nearest = i;
    const bool is_types = is_types_row(here);
    if (!is_types && !(out.units.empty() && is_units_row(here))) {
      at = i;
      break;
    }
    if (!is_types) out.units = here;
    out.has_rows_between = true;
  }
  if (at == lines.size()) {  // what has no names above it is the names
    out.units.clear();
    out.has_rows_between = false;
    at = nearest < lines.size() ? nearest : out.first_row - 1;
  }
  out.names_line = at;
  out.names = names_in(lines[at], out.style);
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
  if (has_units_row) found.emplace_back("a row of units");
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
  for (const FieldStyle& style : styles) {
    std::vector<LineFacts> own = all_facts(lines, style);
    const double reached = score(own);
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
    take_names(lines, fields, out);
    out.has_units_row = !out.units.empty();
    take_edges(lines, fields, out);
    take_value_units(lines[out.first_row], out);
  }
  for (std::size_t i = out.names_line; i < std::min(lines.size(), out.first_row + 1); ++i)
    out.is_quoted = out.is_quoted || lines[i].find('"') != std::string::npos;
  return out;
}

}  // namespace pneuservo
