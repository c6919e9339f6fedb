// Fields and their values in words: what dump and manual page say of a key.
#include "config/field_text.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuservo {

std::string range_text(const Field& field) {
  if (!field.choices.empty()) return fmt::format("{}", fmt::join(field.choices, ", "));
  const bool below = std::isfinite(field.minimum), above = std::isfinite(field.maximum);
  if (field.minimum == field.maximum) return "";
  if (below && above) return fmt::format("{} to {}", number_text(field.minimum), number_text(field.maximum));
  if (below) return fmt::format("at least {}", number_text(field.minimum));
  return above ? fmt::format("at most {}", number_text(field.maximum)) : "";
}

std::string yaml_text(std::string_view text) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto is_plain = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.' || c == '/';
  };
  const bool is_null = text == "null" || text == "Null" || text == "NULL";
  const bool plain_start = !text.empty() && (is_letter(text.front()) || text.front() == '/');
  if (plain_start && std::all_of(text.begin(), text.end(), is_plain) && !is_null) return std::string(text);
  std::string quoted;
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += fmt::format("\\{}", c);
    else if (static_cast<unsigned char>(c) < 0x20) quoted += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else quoted += c;
  }
  return fmt::format("\"{}\"", quoted);
}

}  // namespace pneuservo
