// Fields and their values in words: what dump and manual page say of a key.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include <pneuservo/core/field.hpp>
#include <pneuservo/hal/can_object.hpp>

#include "config/number_text.hpp"
#include "config/reference_fields.hpp"

namespace pneuservo {

/// "0.01 to 100", "at least 0", "valve, chamber, estimated"; empty where nothing is said.
std::string range_text(const Field& field);

/// A text as YAML: plain where that is safe, else in double quotes.
std::string yaml_text(std::string_view text);

/// A value as YAML.
template <class T> std::string value_text(const Field& field, const T& value) {
  if constexpr (std::is_same_v<T, bool>) return value ? "true" : "false";
  else if constexpr (std::is_enum_v<T>) return std::string(field.choices[static_cast<std::size_t>(value)]);
  else if constexpr (std::is_same_v<T, CanObject>) return fmt::format("0x{:08x}", value.word);
  else if constexpr (std::is_integral_v<T>) return std::to_string(value);
  else if constexpr (std::is_floating_point_v<T>) return number_text(value);
  else return yaml_text(value);
}
template <class List> std::string list_text(const List& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number_text(value));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

/// What a key accepts: its range, choices or type.
template <class T> std::string accepted_text(const Field& field, const T&) {
  if constexpr (std::is_same_v<T, bool>) return "true, false";
  else if constexpr (std::is_same_v<T, int>) return fmt::format("{}", fmt::join(reference_degrees, ", "));
  else if constexpr (std::is_same_v<T, std::uint64_t>) return "whole number";
  else if constexpr (std::is_same_v<T, CanObject>) return "0x and 8 hexadecimal digits";
  else if constexpr (std::is_same_v<T, std::string>) return field.choices.empty() ? "text" : range_text(field);
  else if constexpr (std::is_same_v<T, std::vector<double>>) return "list, each " + range_text(field);
  else if constexpr (std::is_same_v<T, std::vector<std::array<double, 3>>> ||
                     std::is_same_v<T, std::vector<ReferenceSpec>>)
    return "list";
  else if constexpr (std::is_same_v<T, std::map<std::string, double>>) return "section";
  else return range_text(field);
}

/// An optional number that its own field would refuse, or an empty text, stands for "not stated" (ramp_s: one period).
template <class T> bool is_unstated(const Field& field, const T& value) {
  if constexpr (std::is_same_v<T, double>) return field.presence == Presence::optional && value < field.minimum;
  else if constexpr (std::is_same_v<T, std::string>) return field.presence == Presence::optional && value.empty();
  else if constexpr (std::is_same_v<T, CanObject>) return field.presence == Presence::optional && value.word == 0;
  else return false;
}

}  // namespace pneuservo
