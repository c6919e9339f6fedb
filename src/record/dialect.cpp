// How a foreign table is written, found from its first lines.
#include "record/dialect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

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
constexpr std::array<std::string_view, 44> units{
    "s",    "ms",     "us",  "\u00b5s", "ns",   "sec",   "m",       "mm",  "cm",    "um",     "\u00b5m",
    "in",   "V",      "mV",  "N",       "kN",   "Pa",    "kPa",     "MPa", "hPa",   "bar",    "mbar",
    "barg", "bara",   "psi", "-",       "1",    "%",     "\u00b0C", "K",   "A",     "mA",     "rad",
    "deg",  "\u00b0", "m/s", "mm/s",    "kg/s", "l/min", "Hz",      "kg",  "count", "counts", "bool"};

/// What a line holds in a style.
struct LineFacts {
  std::size_t fields = 0, numbers = 0, empty = 0;
  bool is_row() const { return numbers > 0 && 2 * (numbers + empty) > fields; }
};

LineFacts facts_of(std::string_view line, const FieldStyle& style) {
  std::vector<std::string_view> fields;
  split_fields(line, style, fields);
  LineFacts facts{fields.size(), 0, 0};
  for (const std::string_view field : fields) {
    double value = 0;
    if (field.empty()) ++facts.empty;
    else if (number_in(field, style.decimal, value) || clock_in(field)) ++facts.numbers;
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

/// Fields that are numbers less what is neither number nor empty: cutting at the wrong place makes both.
double score(const std::vector<LineFacts>& facts) {
  const std::size_t usual = usual_fields(facts);
  double sum = 0;
  for (const LineFacts& line : facts)
    if (line.is_row() && line.fields == usual)
      sum += static_cast<double>(line.numbers) - 2.0 * static_cast<double>(line.fields - line.numbers - line.empty);
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
    known += !field.empty() && is_unit(field);
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

/// The line of names above the first row: the nearest whose fields are those of the rows, or one fewer where the rows
/// have an index or a trailing separator. A row of units may stand between.
void take_names(const std::vector<std::string>& lines, std::size_t fields, Dialect& out) {
  std::size_t at = lines.size();
  for (std::size_t i = out.first_row; i-- > 0;) {
    const std::vector<std::string> here = names_in(lines[i], out.style);
    const bool matches = here.size() == fields || here.size() + 1 == fields || 2 * here.size() == fields;
    if (!matches) continue;
    if (at == lines.size() && is_units_row(here) && i > 0) {
      out.units = here;
      continue;
    }
    at = i;
    break;
  }
  if (at == lines.size()) {  // units that have no names above them are the names
    out.units.clear();
    at = out.first_row - 1;
  }
  out.names_line = at;
  out.names = names_in(lines[at], out.style);
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

bool is_unit(std::string_view text) {
  text = trimmed(text);
  if (text.size() >= 2 && std::string_view("[(").find(text.front()) != std::string_view::npos)
    text = trimmed(text.substr(1, text.size() - 2));
  return std::find(units.begin(), units.end(), text) != units.end();
}

std::string Dialect::words() const {
  std::vector<std::string> found;
  if (style.separator != ',')
    found.push_back(style.separator == '\t'  ? "separator tab"
                    : style.separator == ' ' ? "separator blanks"
                                             : fmt::format("separator {}", style.separator));
  if (style.decimal == ',') found.emplace_back("decimal comma");
  if (is_quoted) found.emplace_back("quotes");
  if (names_line > 0) found.push_back(fmt::format("{} line{} before the names", names_line, names_line > 1 ? "s" : ""));
  if (!units.empty()) found.emplace_back("a row of units");
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
  const auto first = std::find_if(facts.begin(), facts.end(),
                                  [&](const LineFacts& line) { return line.is_row() && line.fields == fields; });
  out.first_row = static_cast<std::size_t>(first - facts.begin());
  if (best <= 0 || out.first_row == 0 || out.first_row == lines.size()) {
    out.style = {};
    out.first_row = 1;
    out.names = names_in(lines[0], out.style);
  } else {
    take_names(lines, fields, out);
    take_edges(lines, fields, out);
  }
  for (std::size_t i = out.names_line; i < std::min(lines.size(), out.first_row + 1); ++i)
    out.is_quoted = out.is_quoted || lines[i].find('"') != std::string::npos;
  return out;
}

}  // namespace pneuservo
