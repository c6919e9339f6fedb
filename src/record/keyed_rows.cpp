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

std::vector<std::string> names_in(std::string_view line, const KeyedRows& how) {
  std::vector<std::string_view> fields;
  split_fields(line, {how.separator, '.', false}, fields);
  std::vector<std::string> names;
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
  std::vector<std::string_view> fields;
  split_fields(line, {separator, '.', false}, fields);
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
