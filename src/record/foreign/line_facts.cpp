// What the lines of a foreign table hold, cut in a given style.
#include "record/foreign/line_facts.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "record/foreign/clock_text.hpp"
#include "record/foreign/units.hpp"

namespace pneuservo {

bool is_value(std::string_view field, const FieldStyle& style) {
  double value = 0;
  return number_in(field, style.decimal, value) || clock_in(field) || hexadecimal_in(field, value) ||
         number_in(trimmed(field.substr(0, unit_start(field))), style.decimal, value) ||
         (style.has_groups && number_with_groups(field, style.decimal, value));
}

namespace {

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

}  // namespace

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
  even_ends(facts);
  return facts;
}

std::size_t first_row(const std::vector<LineFacts>& facts, std::size_t fields) {
  std::size_t labelled = 0, rows = 0;
  for (const LineFacts& line : facts)
    if (line.is_row() && line.fields == fields) labelled += line.has_label(), ++rows;
  const auto at = std::find_if(facts.begin(), facts.end(), [&](const LineFacts& line) {
    return line.is_row() && line.fields == fields && (!line.has_label() || 2 * labelled > rows);
  });
  return static_cast<std::size_t>(at - facts.begin());
}

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

bool are_values_alone(const std::vector<LineFacts>& facts) {
  const std::size_t usual = usual_fields(facts);
  return usual > 1 && std::all_of(facts.begin(), facts.end(), [&](const LineFacts& line) {
           return !line.is_row() || line.fields != usual ||
                  std::find(line.is_text.begin(), line.is_text.end(), 1) == line.is_text.end();
         });
}

}  // namespace pneuservo
