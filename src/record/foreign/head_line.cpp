// What a line above the rows of a foreign table says.
#include "record/foreign/head_line.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string_view>

#include "record/foreign/field_text.hpp"
#include "record/foreign/line_facts.hpp"
#include "record/foreign/units.hpp"

namespace pneuservo {

namespace {

/// Units of the times of several columns, such as "HUnit,s,s": not those of their values.
bool are_all_times(const std::vector<std::string>& fields) {
  std::size_t times = 0, others = 0;
  for (const std::string& field : fields)
    if (const std::optional<Unit> unit = unit_in(field)) ++(unit->quantity == Quantity::time ? times : others);
  return times > 1 && others == 0 && is_units_row(fields);
}

void take_labels_off(std::vector<std::string>& fields) {
  for (std::string& field : fields) field = trimmed(std::string_view(field).substr(field.find_first_of(":=") + 1));
}

}  // namespace

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

bool is_types_row(const std::vector<std::string>& fields) {
  constexpr std::array<std::string_view, 23> types{"double",  "float",   "single", "int",    "uint",  "sint",
                                                   "usint",   "dint",    "udint",  "lint",   "ulint", "integer",
                                                   "real",    "lreal",   "bool",   "byte",   "word",  "dword",
                                                   "numeric", "boolean", "string", "number", "long"};
  constexpr std::array<std::string_view, 8> types_of_times{"time", "ltime", "date",     "tod",
                                                           "dt",   "ldt",   "datetime", "timestamp"};
  constexpr std::string_view letters_with_size = "fiub";  // f8, u16
  std::size_t filled = 0, times = 0;
  for (const std::string& field : fields) {
    std::string letters = in_small_letters(field);
    while (!letters.empty() && std::isdigit(static_cast<unsigned char>(letters.back())) != 0) letters.pop_back();
    const bool is_sized = letters.size() == 1 && letters.size() < field.size() &&
                          letters_with_size.find(letters) != std::string_view::npos;
    const bool is_time = std::find(types_of_times.begin(), types_of_times.end(), letters) != types_of_times.end();
    if (!field.empty() && !is_sized && !is_time && std::find(types.begin(), types.end(), letters) == types.end())
      return false;
    filled += !field.empty();
    times += is_time;
  }
  return filled > times;
}

bool is_ruled(const std::vector<std::string>& fields) {
  return std::all_of(fields.begin(), fields.end(),
                     [](const std::string& field) { return field.find_first_not_of("-=+:_") == std::string::npos; });
}

bool states_values(const std::vector<std::string>& fields, const FieldStyle& style) {
  return std::all_of(fields.begin(), fields.end(), [&style](const std::string& field) {
    const std::size_t sign = field.find_first_of("=:");
    return sign != std::string::npos && sign > 0 && is_value(trimmed(std::string_view(field).substr(sign + 1)), style);
  });
}

std::vector<std::string> head_fields(const std::string& line, const FieldStyle& style, std::size_t fields) {
  std::vector<std::string> out = names_in(line, style);
  if (style.separator == ';' && out.size() == fields + 1 && out.front().empty() && !out.back().empty())
    out.erase(out.begin());
  return out;
}

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

namespace {

/// "Unit", "Einheit:", "Y_Unit_Label", "HUnit".
bool says_unit(std::string_view label) {
  for (std::size_t begin = 0; begin < label.size();) {
    const auto end = static_cast<std::size_t>(
        std::find_if_not(label.begin() + static_cast<std::ptrdiff_t>(begin), label.end(), is_letter) - label.begin());
    const std::string_view word = label.substr(begin, end - begin);
    if (is_unit_word(word) || in_small_letters(word).ends_with("unit")) return true;
    begin = end + 1;
  }
  return false;
}

}  // namespace

HeadLine judge_head_line(std::vector<std::string>& here, const std::string& line, std::size_t fields,
                         const FieldStyle& style) {
  if (style.separator == ' ' && here.size() > fields) {
    std::vector<std::string> joined = names_with_blanks(line, fields);
    if (joined.size() == fields) here = std::move(joined);
  }
  if (here.size() == 2 && here[1] == "*" && is_value(here[0], style)) return HeadLine::stated;  // a factor of all
  std::size_t filled = 0;
  for (const std::string& field : here) filled += !field.empty();
  if (filled > 0 && is_ruled(here)) return HeadLine::ruled;
  if (3 * filled <= here.size()) return HeadLine::other;  // labels of a head
  const bool matches = here.size() == fields || here.size() + 1 == fields || 2 * here.size() == fields;
  if (!matches) return here.size() > fields && style.separator != ' ' ? HeadLine::longer : HeadLine::other;
  if (const std::string label = common_label(here); says_unit(label)) take_labels_off(here);
  else if (!label.empty() && label.find("name") == std::string::npos) return HeadLine::stated;
  if (states_values(here, style)) return HeadLine::stated;
  if (is_types_row(here)) return HeadLine::types;
  if (are_all_times(here)) return HeadLine::stated;
  return is_units_row(here) ? HeadLine::units : HeadLine::names;
}

std::string common_label(const std::vector<std::string>& fields) {
  std::string label;
  std::size_t filled = 0;
  for (const std::string& field : fields) {
    if (field.empty()) continue;
    const std::size_t sign = field.find_first_of(":=");
    const std::string own = in_small_letters(trimmed(std::string_view(field).substr(0, sign)));
    if (sign == std::string::npos || own.empty() || (filled++ > 0 && own != label)) return "";
    label = own;
  }
  return filled > 1 ? label : "";
}

bool states_factors(const std::vector<std::string>& fields, const FieldStyle& style, std::size_t columns) {
  constexpr std::array<std::string_view, 13> factors{
      "scale",      "scaling",    "scale factor",      "scalefactor", "factor",
      "multiplier", "gain",       "conversion factor", "conversion",  "slope",
      "faktor",     "skalierung", "skalierungsfaktor"};
  if (fields.size() < 2 || fields.size() + 1 < columns) return false;
  if (fields.size() > 2 && fields[0] == fields[2]) return false;  // of pairs, whose export has them applied
  std::string label = in_small_letters(fields[0]);
  if (label.ends_with(':')) label.pop_back();
  const bool is_offset = label == "offset";
  if (!is_offset && std::find(factors.begin(), factors.end(), label) == factors.end()) return false;
  return std::any_of(fields.begin() + 1, fields.end(), [&](const std::string& field) {
    double value = 0;
    return number_in(field, style.decimal, value) && value != (is_offset ? 0 : 1);
  });
}

bool is_unit_label(const std::vector<std::string>& fields) { return !fields.empty() && says_unit(fields[0]); }

}  // namespace pneuservo
