// Reads sections of a config into parameter structs: types, ranges and presence come from the structs' own fields.
#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/core/field.hpp>
#include <pneuservo/hal/can_object.hpp>

#include "config/config_tree.hpp"
#include "config/data_sheet.hpp"
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
void read_value(const Field& field, const ConfigNode& node, const std::string& path,
                std::map<std::string, double>& values);
/// A reference with its parts; errors of single keys go to the context.
void read_reference(ConfigNode& node, const std::string& path, ReferenceSpec& reference, ReadContext& context);

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
/// Tells every key that no field has; a field that such a key was meant for is excused from being missed.
void tell_unknown_keys(const ConfigNode& map, const std::string& path, const std::vector<Field>& fields,
                       ReadContext& context, std::set<std::string>& excused);
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
template <ParameterSection P>
void read_section(ConfigNode& node, const std::string& path, P& section, ReadContext& context);

/// Visits the fields of one section and reads those that its map has; each error goes to the context.
struct SectionReader {
  ConfigNode& map;
  const std::string& path;
  ReadContext& context;
  bool choices_only = false;  ///< first pass: a wrong kind is named before the keys that only another kind has
  const std::set<std::string>* excused = nullptr;  ///< keys that may be missing: what was meant for them is told

  template <class T> void operator()(const Field& field, T& value) const {
    if (choices_only && field.choices.empty()) return;
    const std::string key(field.key);
    ConfigNode::Entry* entry = map.find(key);
    context.errors.collect([&] {
      if (entry != nullptr) read_one(field, entry->value, join_path(path, key), value);
      else if (field.presence == Presence::required && !choices_only && !(excused != nullptr && excused->contains(key)))
        refuse_missing(map, path, field, expected_value<T>(field));
    });
  }

 private:
  template <class T>
  void read_one(const Field& field, ConfigNode& node, const std::string& node_path, T& value) const {
    if constexpr (ParameterSection<T>) read_section(node, node_path, value, context);
    else if constexpr (std::is_same_v<T, ReferenceSpec>) read_reference(node, node_path, value, context);
    else read_value(field, node, node_path, value);
  }
  void read_one(const Field& field, ConfigNode& node, const std::string& node_path,
                std::vector<ReferenceSpec>& parts) const;
  template <ParameterSection T>
  void read_one(const Field&, ConfigNode& node, const std::string& node_path, std::optional<T>& value) const {
    read_section(node, node_path, value.emplace(), context);
  }
  template <ParameterSection T>
  void read_one(const Field&, ConfigNode& node, const std::string& node_path, std::map<std::string, T>& values) const {
    require_map(node, node_path);
    values.clear();
    for (ConfigNode::Entry& entry : node.entries)
      context.errors.collect(
          [&] { read_section(entry.value, join_path(node_path, entry.key), values[entry.key], context); });
  }
};

/// Choices first, since they decide which keys there are; then data-sheet keys into SI keys, then all keys.
template <ParameterSection P>
void read_section(ConfigNode& node, const std::string& path, P& section, ReadContext& context) {
  require_map(node, path);
  const std::size_t before = context.errors.size();
  P::visit(SectionReader{node, path, context, true}, section);
  const std::vector<Field> fields = fields_of(section);
  std::set<std::string> excused = translate_data_sheet(node, path, fields, context);
  const bool is_kind_known = context.errors.size() == before || node.find("kind") == nullptr;
  if (is_kind_known) tell_unknown_keys(node, path, fields, context, excused);
  if (is_kind_known) P::visit(SectionReader{node, path, context, false, &excused}, section);
}

/// A document that is one section. Throws all its errors as one InputError.
template <ParameterSection P> void read_document(ConfigNode node, P& section) {
  InputErrors errors;
  const Rig no_rig;
  ReadContext context{no_rig, errors};
  errors.collect([&] { read_section(node, "", section, context); });
  errors.throw_if_any();
}

}  // namespace pneuservo
