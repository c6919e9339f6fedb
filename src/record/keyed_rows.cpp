// Rows whose fields bear their names.
#include "record/keyed_rows.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

}  // namespace

std::string KeyedRows::names_line() const {
  return fmt::format("{}", fmt::join(names, std::string_view(&separator, 1)));
}

std::string KeyedRows::row(std::string_view line) const {
  const std::string_view stamp = stamp_taken_from(line);
  std::vector<std::string_view> fields;
  split_fields(line, {separator, '.', false}, fields);
  if (!stamp.empty()) fields.insert(fields.begin(), stamp);
  for (std::size_t i = 0; i < std::min(fields.size(), names.size()); ++i)
    if (name_in(fields[i], sign) == names[i]) fields[i] = trimmed(fields[i].substr(fields[i].find(sign) + 1));
  return fmt::format("{}", fmt::join(fields, std::string_view(&separator, 1)));
}

KeyedRows find_keyed_rows(const std::vector<std::string>& lines) {
  for (const char separator : {',', ';', '\t', ' '})
    for (const char sign : {':', '='}) {
      KeyedRows how{separator, sign, {}};
      // The last line of the sample speaks: a logger's first words are often others.
      how.names = names_in(lines.back(), how);
      if (how.names.size() < 2) continue;
      std::size_t alike = 0;
      for (const std::string& line : lines) alike += names_in(line, how) == how.names;
      if (10 * alike >= 9 * lines.size()) return how;
    }
  return {};
}

}  // namespace pneuservo
