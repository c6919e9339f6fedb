// Reads sections of a config into parameter structs: types, ranges and presence come from the structs' own fields.
#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/core/field.hpp>
#include <pneuservo/hal/can_object.hpp>

#include "config/config_tree.hpp"
#include "config/key_suggestion.hpp"

namespace pneuservo {

/// Takes whatever a visit offers.
struct IgnoreFields {
  template <class... T> void operator()(const Field&, T&...) const {}
};

/// A struct that declares its fields in a visit.
template <class T>
concept ParameterSection = std::is_class_v<T> && requires(T& section) { T::visit(IgnoreFields{}, section); };

/// The fields of a visit, in their order.
struct FieldCollector {
  std::vector<Field>& fields;
  template <class... T> void operator()(const Field& field, T&...) const { fields.push_back(field); }
};
/// Of this section: its keys may follow a kind that stands in it.
template <class Section> std::vector<Field> fields_of(const Section& section) {
  std::vector<Field> fields;
  Section::visit(FieldCollector{fields}, section);
  return fields;
}

/// What a field accepts, for the words after "expected": "a number in m, 0.01 to 100".
std::string expected_number(const Field& field);

/// The words of a field with choices: "one of valve, chamber, estimated".
std::string expected_choice(const Field& field);

/// Throws InputError unless the value is finite (infinity only where the field's range has it) and within the range.
void require_in_range(const Field& field, double value, const std::string& origin, const std::string& path,
                      const std::string& found);

// One value each; every one throws InputError naming origin and path.
void read_value(const Field& field, const ConfigNode& node, const std::string& path, double& value);
void read_value(const Field& field, const ConfigNode& node, const std::string& path, bool& value);
void read_value(const Field& field, const ConfigNode& node, const std::string& path, std::uint64_t& value);
void read_value(const Field& field, const ConfigNode& node, const std::string& path, std::uint32_t& value);
void read_value(const Field& field, const ConfigNode& node, const std::string& path, int& degree);
void read_value(const Field& field, const ConfigNode& node, const std::string& path, CanObject& value);
void read_value(const Field& field, const ConfigNode& node, const std::string& path, std::string& value);
void read_value(const Field& field, const ConfigNode& node, const std::string& path, std::vector<double>& values);
void read_value(const Field& field, const ConfigNode& node, const std::string& path,
                std::vector<std::array<double, 3>>& values);
void read_value(const Field& field, const ConfigNode& node, const std::string& path, std::vector<ReferenceSpec>& parts);
void read_value(const Field& field, const ConfigNode& node, const std::string& path,
                std::map<std::string, double>& values);
void read_value(const Field& field, const ConfigNode& node, const std::string& path, ReferenceSpec& reference);

/// Index of a choice among the field's names.
int read_choice(const Field& field, const ConfigNode& node, const std::string& path);
template <class E>
  requires std::is_enum_v<E>
void read_value(const Field& field, const ConfigNode& node, const std::string& path, E& value) {
  value = static_cast<E>(read_choice(field, node, path));
}
template <class T>
  requires(!ParameterSection<T>)
void read_value(const Field& field, const ConfigNode& node, const std::string& path, std::optional<T>& value) {
  read_value(field, node, path, value.emplace());
}

/// Refuses what is not a map.
void require_map(const ConfigNode& node, const std::string& path);
/// Refuses the first key that no field has.
void require_known_keys(const ConfigNode& map, const std::string& path, const std::vector<Field>& fields);
/// Refuses a map that lacks a required key; `what` says what the key should hold.
[[noreturn]] void refuse_missing(const ConfigNode& map, const std::string& path, const Field& field,
                                 const std::string& what);
/// What a missing key should be: "a number in m, 0.01 to 100", "this required section".
template <class T> std::string expected_value(const Field& field) {
  if constexpr (std::is_same_v<T, double>) return expected_number(field);
  else if constexpr (std::is_enum_v<T>) return expected_choice(field);
  else if constexpr (ParameterSection<T> || std::is_same_v<T, ReferenceSpec>) return "this required section";
  else return "this required key";
}
template <ParameterSection P> void read_section(const ConfigNode& node, const std::string& path, P& section);

/// Visits the fields of one section and reads those that its map has.
struct SectionReader {
  const ConfigNode& map;
  const std::string& path;
  bool choices_only = false;  ///< first pass: a wrong kind is named before the keys that only another kind has

  template <class T> void operator()(const Field& field, T& value) const {
    if (choices_only && field.choices.empty()) return;
    const std::string key(field.key);
    const ConfigNode::Entry* entry = map.find(key);
    if (entry != nullptr) read_one(field, entry->value, join_path(path, key), value);
    else if (field.presence == Presence::required && !choices_only)
      refuse_missing(map, path, field, expected_value<T>(field));
  }

 private:
  template <class T>
  static void read_one(const Field& field, const ConfigNode& node, const std::string& path, T& value) {
    if constexpr (ParameterSection<T>) read_section(node, path, value);
    else read_value(field, node, path, value);
  }
  template <ParameterSection T>
  static void read_one(const Field&, const ConfigNode& node, const std::string& path, std::optional<T>& value) {
    read_section(node, path, value.emplace());
  }
  template <ParameterSection T>
  static void read_one(const Field&, const ConfigNode& node, const std::string& path,
                       std::map<std::string, T>& values) {
    require_map(node, path);
    values.clear();
    for (const ConfigNode::Entry& entry : node.entries)
      read_section(entry.value, join_path(path, entry.key), values[entry.key]);
  }
};

template <ParameterSection P> void read_section(const ConfigNode& node, const std::string& path, P& section) {
  require_map(node, path);
  P::visit(SectionReader{node, path, true}, section);
  require_known_keys(node, path, fields_of(section));
  P::visit(SectionReader{node, path}, section);
}

}  // namespace pneuservo
