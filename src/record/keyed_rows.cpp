// Rows whose fields bear their names.
#include "record/keyed_rows.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "record/clock_text.hpp"
#include "record/field_text.hpp"

namespace pneuservo {

namespace {

/// The name before the sign in a field whose rest is a number; empty where it is none.
std::string_view name_in(std::string_view field, char sign) {
  const std::size_t at = field.find(sign);
  if (at == std::string_view::npos || at == 0 || std::isalpha(static_cast<unsigned char>(field.front())) == 0)
    return {};
  double value = 0;
  return number_in(trimmed(field.substr(at + 1)), '.', value) ? trimmed(field.substr(0, at)) : std::string_view();
}

constexpr std::string_view stamp_name = "Timestamp";

/// What a serial monitor sets before a line, "10:15:00.020 -> "; the line goes on behind it.
std::string_view stamp_taken_from(std::string_view& line) {
  constexpr std::string_view arrow = " -> ";
  const std::size_t at = line.find(arrow);
  if (at == std::string_view::npos || at == 0 || line.find_first_not_of("0123456789:.") != at) return {};
  const std::string_view stamp = line.substr(0, at);
  line.remove_prefix(at + arrow.size());
  return stamp;
}

std::vector<std::string> names_in(std::string_view line, const KeyedRows& how) {
  std::vector<std::string> names;
  if (!stamp_taken_from(line).empty()) names.emplace_back(stamp_name);
  std::vector<std::string_view> fields;
  split_fields(line, {how.separator, '.', false}, fields);
  for (const std::string_view field : fields) {
    const std::string_view name = name_in(field, how.sign);
    if (name.empty()) return {};
    names.emplace_back(name);
  }
  return names;
}

/// A name and its value.
using NamedValue = std::pair<std::string, std::string>;

bool is_part_of_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80 ||
         std::string_view("_./-").find(c) != std::string_view::npos;
}

/// Where the name begins that ends before a sign, its quotes included; the sign's place where there is none.
std::size_t name_begin(std::string_view line, std::size_t sign) {
  std::size_t end = sign;
  while (end > 0 && line[end - 1] == ' ') --end;
  std::size_t begin = end;
  const bool is_quoted = end > 1 && line[end - 1] == '"';
  if (is_quoted) {
    begin = line.rfind('"', end - 2);
    return begin == std::string_view::npos ? sign : begin;
  }
  while (begin > 0 && is_part_of_name(line[begin - 1])) --begin;
  const bool has_letter = begin < end && (std::isalpha(static_cast<unsigned char>(line[begin])) != 0 ||
                                          static_cast<unsigned char>(line[begin]) >= 0x80 || line[begin] == '_');
  return has_letter ? begin : sign;
}

/// The value behind a sign: a number, one with the "i" of an integer, or a text in quotes; empty where it is none.
std::string_view value_behind(std::string_view line, std::size_t sign) {
  std::string_view rest = trimmed(line.substr(sign + 1));
  if (rest.starts_with('"')) {
    rest.remove_prefix(1);
    rest = rest.substr(0, std::min(rest.find('"'), rest.size()));
    return rest;
  }
  rest = rest.substr(0, std::min(rest.find_first_of(" ,;}\t]"), rest.size()));
  double value = 0;
  if (rest.size() > 1 && rest.ends_with('i') && number_in(rest.substr(0, rest.size() - 1), '.', value))
    rest.remove_suffix(1);
  return number_in(rest, '.', value) ? rest : std::string_view();
}

/// The date or time of the day that begins a line, in brackets or not; empty where there is none.
std::string stamp_in_front(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('[')) text.remove_prefix(1);
  const std::size_t word = std::min(text.find(' '), text.size());
  const std::size_t second = std::min(text.find(' ', std::min(word + 1, text.size())), text.size());
  for (const std::size_t end : {second, word}) {
    std::string_view stamp = text.substr(0, end);
    while (!stamp.empty() && (stamp.back() == ']' || stamp.back() == ':' || stamp.back() == ' '))
      stamp.remove_suffix(1);
    if (!clock_in(stamp)) continue;
    std::string out(stamp);
    std::replace(out.begin(), out.end(), ',', '.');  // of decimals
    return out;
  }
  return "";
}

/// Numbers that stand in a text by themselves.
std::size_t numbers_in(std::string_view text) {
  std::size_t count = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(" ,;|\t{}[]"), text.size());
    double value = 0;
    count += number_in(text.substr(0, end), '.', value);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return count;
}

/// Values with their names wherever they stand in a line. A stamp before them, or a count of ten digits and more
/// behind, is a time. None where as many numbers have no name: a table with remarks.
std::vector<NamedValue> scanned(std::string_view line) {
  std::vector<NamedValue> out;
  std::size_t first = line.size(), behind = 0, nameless = 0;
  for (std::size_t sign = line.find_first_of("=:"); sign != std::string_view::npos;
       sign = line.find_first_of("=:", sign + 1)) {
    const std::size_t begin = name_begin(line, sign);
    const std::string_view value = begin < sign ? value_behind(line, sign) : std::string_view();
    if (value.empty()) continue;
    std::string_view name = trimmed(line.substr(begin, sign - begin));
    if (name.starts_with('"')) name = name.substr(1, name.size() - 2);
    first = std::min(first, begin);
    nameless += behind > 0 && begin > behind ? numbers_in(line.substr(behind, begin - behind)) : 0;
    behind = static_cast<std::size_t>(value.data() + value.size() - line.data());
    out.emplace_back(name, value);
  }
  if (out.empty()) return out;
  constexpr std::size_t digits_of_epoch = 10;
  std::string_view front = line.substr(0, first);
  std::string stamp = stamp_in_front(front);
  if (!stamp.empty()) front.remove_prefix(std::min(front.find(stamp.front()) + stamp.size(), front.size()));
  nameless += numbers_in(front);
  std::string_view rest = line.substr(behind);
  if (rest.starts_with('i')) rest.remove_prefix(1);
  rest = trimmed(rest);
  const bool is_count =
      rest.size() >= digits_of_epoch && rest.find_first_not_of("0123456789") == std::string_view::npos;
  nameless += is_count ? 0 : numbers_in(rest);
  if (nameless >= out.size()) return {};
  if (stamp.empty() && is_count) stamp = rest;
  if (!stamp.empty()) out.emplace(out.begin(), stamp_name, stamp);
  return out;
}

std::vector<std::string> scanned_names(const std::vector<NamedValue>& values) {
  std::vector<std::string> out;
  for (const auto& [name, value] : values) out.push_back(name);
  return out;
}

/// Of lines that hold the same names, at least two beside a stamp, each once.
KeyedRows find_scanned_rows(const std::vector<std::string>& lines) {
  KeyedRows how{',', '=', true, scanned_names(scanned(lines.back()))};
  const std::set<std::string> different(how.names.begin(), how.names.end());
  if (different.size() != how.names.size() || how.names.size() < 2 + different.count(std::string(stamp_name)))
    return {};
  std::size_t alike = 0;
  for (const std::string& line : lines) alike += scanned_names(scanned(line)) == how.names;
  return 10 * alike >= 9 * lines.size() ? how : KeyedRows();
}

}  // namespace

std::string KeyedRows::names_line() const {
  return fmt::format("{}", fmt::join(names, std::string_view(&separator, 1)));
}

std::string KeyedRows::row(std::string_view line) const {
  if (is_scanned) {
    const std::vector<NamedValue> found = scanned(line);
    std::vector<std::string> values(names.size());
    for (const auto& [name, value] : found)
      if (const auto at = std::find(names.begin(), names.end(), name); at != names.end())
        values[static_cast<std::size_t>(at - names.begin())] =
            value.find(',') == std::string::npos ? value : "\"" + value + "\"";
    return found.empty() ? std::string(line) : fmt::format("{}", fmt::join(values, ","));
  }
  const std::string_view stamp = stamp_taken_from(line);
  std::vector<std::string_view> fields;
  split_fields(line, {separator, '.', false}, fields);
  if (!stamp.empty()) fields.insert(fields.begin(), stamp);
  for (std::size_t i = 0; i < std::min(fields.size(), names.size()); ++i)
    if (name_in(fields[i], sign) == names[i]) fields[i] = trimmed(fields[i].substr(fields[i].find(sign) + 1));
  return fmt::format("{}", fmt::join(fields, std::string_view(&separator, 1)));
}

bool KeyedRows::holds_values(std::string_view line) const { return !is_scanned || !scanned(line).empty(); }

KeyedRows find_keyed_rows(const std::vector<std::string>& lines) {
  for (const char separator : {',', ';', '\t', ' '})
    for (const char sign : {':', '='}) {
      KeyedRows how{separator, sign, false, {}};
      // The last line of the sample speaks: a logger's first words are often others.
      how.names = names_in(lines.back(), how);
      if (how.names.size() < 2) continue;
      std::size_t alike = 0;
      for (const std::string& line : lines) alike += names_in(line, how) == how.names;
      if (10 * alike >= 9 * lines.size()) return how;
    }
  return find_scanned_rows(lines);
}

}  // namespace pneuservo
