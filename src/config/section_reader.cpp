// Reads sections of a config into parameter structs: types, ranges and presence come from the structs' own fields.
#include "config/section_reader.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "config/number_text.hpp"
#include "config/reference_fields.hpp"
#include "config/units.hpp"

namespace pneuservo {

namespace {

using Type = ConfigNode::Type;

std::string expected_list(const Field& field, std::string_view of) {
  return fmt::format("a list of {}{}", of, field.unit.empty() ? "" : fmt::format(" in {}", field.unit));
}

const ConfigNode& require_list(const Field& field, const ConfigNode& node, const std::string& path,
                               std::string_view of) {
  if (node.type != Type::list || node.items.empty()) {
    const std::string found = node.type == Type::list ? "an empty list" : describe(node);
    refuse(node.origin, path, found, expected_list(field, of));
  }
  return node;  // NOLINT(bugprone-return-const-ref-from-parameter): of a config that outlives its reading
}

/// Where a value has its unit beside it, the key that takes it.
std::string unit_remedy(const Field& field, const ConfigNode& node) {
  const std::string_view key = key_without_unit(field);
  if (key.empty() || node.type != Type::scalar || !read_quantity(field, node.text, {}).value) return "";
  return fmt::format("; with a unit the key is {}", key);
}

}  // namespace

std::string expected_number(const Field& field) {
  const bool has_unit = !field.unit.empty() && field.unit != "-";
  std::string text = has_unit ? fmt::format("a number in {}", field.unit) : "a number";
  const bool bounded_below = std::isfinite(field.minimum), bounded_above = std::isfinite(field.maximum);
  if (bounded_below && bounded_above)
    text += fmt::format(", {} to {}", number_text(field.minimum), number_text(field.maximum));
  else if (bounded_below) text += fmt::format(", at least {}", number_text(field.minimum));
  else if (bounded_above) text += fmt::format(", at most {}", number_text(field.maximum));
  return text;
}

std::string expected_choice(const Field& field) {
  return fmt::format("{}{}", field.choices.size() > 1 ? "one of " : "", fmt::join(field.choices, ", "));
}

void require_in_range(const Field& field, double value, const std::string& origin, const std::string& path,
                      const std::string& found) {
  // A comparison that not-a-number fails.
  if (!(value >= field.minimum && value <= field.maximum)) refuse(origin, path, found, expected_number(field));
}

void read_value(const Field& field, const ConfigNode& node, const std::string& path, double& value) {
  std::optional<double> number;
  if (node.type == Type::scalar && !node.quoted) number = number_from_text(node.text);
  const bool is_share = (field.unit.empty() || field.unit == "-") && field.maximum <= 10.0;
  if (!number && is_share && node.type == Type::scalar) number = share_from_text(node.text);
  if (!number) refuse(node.origin, path, describe(node), expected_number(field) + unit_remedy(field, node));
  const std::string found = node.written.empty() ? node.text : fmt::format("{} ({})", node.text, node.written);
  require_in_range(field, *number, node.origin, path, found);
  value = *number;
}

void read_value(const Field&, const ConfigNode& node, const std::string& path, bool& value) {
  const std::string text = node.type == Type::scalar && !node.quoted ? node.text : "";
  value = text == "true" || text == "True" || text == "TRUE";
  if (!value && text != "false" && text != "False" && text != "FALSE")
    refuse(node.origin, path, describe(node), "true or false");
}

void read_value(const Field&, const ConfigNode& node, const std::string& path, std::uint64_t& value) {
  std::from_chars_result result{nullptr, std::errc::invalid_argument};
  const char* const end = node.text.data() + node.text.size();
  if (node.type == Type::scalar && !node.quoted) result = std::from_chars(node.text.data(), end, value);
  if (result.ec != std::errc{} || result.ptr != end)
    refuse(node.origin, path, describe(node), "a whole number from 0 to 18446744073709551615");
}

void read_value(const Field& field, const ConfigNode& node, const std::string& path, std::uint32_t& value) {
  const auto expected = fmt::format("a whole number from {:.0f} to {:.0f}", field.minimum, field.maximum);
  std::uint32_t read = 0;
  std::from_chars_result result{nullptr, std::errc::invalid_argument};
  const char* const end = node.text.data() + node.text.size();
  const int hexadecimal = node.text.starts_with("0x") ? 2 : 0;
  if (node.type == Type::scalar && !node.quoted)
    result = std::from_chars(node.text.data() + hexadecimal, end, read, hexadecimal > 0 ? 16 : 10);
  const bool whole = result.ec == std::errc{} && result.ptr == end;
  if (!whole || read < field.minimum || read > field.maximum) refuse(node.origin, path, describe(node), expected);
  value = read;
}

void read_value(const Field&, const ConfigNode& node, const std::string& path, CanObject& value) {
  constexpr auto expected = "0x and eight hexadecimal digits: index, sub-index, 1 to 32 bits (0x64010110)";
  const bool form = node.type == Type::scalar && !node.quoted && node.text.size() == 10 && node.text.starts_with("0x");
  if (!form) refuse(node.origin, path, describe(node), expected);
  const char* const end = node.text.data() + node.text.size();
  const std::from_chars_result result = std::from_chars(node.text.data() + 2, end, value.word, 16);
  const bool whole = result.ec == std::errc{} && result.ptr == end;
  if (!whole || value.bits() < 1 || value.bits() > 32) refuse(node.origin, path, describe(node), expected);
}

void read_value(const Field& field, const ConfigNode& node, const std::string& path, int& degree) {
  double value = 0.0;
  read_value(field, node, path, value);
  if (std::find(reference_degrees.begin(), reference_degrees.end(), value) == reference_degrees.end())
    refuse(node.origin, path, node.text, fmt::format("one of {}", fmt::join(reference_degrees, ", ")));
  degree = static_cast<int>(value);
}

void read_value(const Field& field, const ConfigNode& node, const std::string& path, std::string& value) {
  if (!field.choices.empty()) {
    value = field.choices[static_cast<std::size_t>(read_choice(field, node, path))];
    return;
  }
  if (node.type != Type::scalar || node.text.empty()) {
    const bool empty = node.type == Type::scalar;
    refuse(node.origin, path, empty ? "an empty text" : describe(node), "a text");
  }
  if (printable(node.text) != node.text)
    refuse(node.origin, path, "a control character in " + describe(node), "a text");
  value = node.text;
}

int read_choice(const Field& field, const ConfigNode& node, const std::string& path) {
  const auto known = std::find(field.choices.begin(), field.choices.end(), node.text);
  if (node.type == Type::scalar && known != field.choices.end()) return static_cast<int>(known - field.choices.begin());
  std::string lower = node.text;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto older = std::find(field.older_words.begin(), field.older_words.end(), lower);
  if (node.type == Type::scalar && older != field.older_words.end())
    return static_cast<int>(older - field.older_words.begin());
  refuse(node.origin, path, describe(node), expected_choice(field));
}

void read_value(const Field& field, const ConfigNode& node, const std::string& path, std::vector<double>& values) {
  values.clear();
  for (const ConfigNode& item : require_list(field, node, path, "numbers").items) {
    const std::string item_path = join_path(path, std::to_string(values.size()));
    read_value(field, item, item_path, values.emplace_back());
  }
}

void read_value(const Field& field, const ConfigNode& node, const std::string& path,
                std::vector<std::array<double, 3>>& values) {
  constexpr auto form = "[amplitude_m, frequency_Hz, phase_rad]";
  values.clear();
  for (const ConfigNode& item : require_list(field, node, path, form).items) {
    const std::string item_path = join_path(path, std::to_string(values.size()));
    if (item.type != Type::list) refuse(item.origin, item_path, describe(item), form);
    if (item.items.size() != 3) refuse(item.origin, item_path, fmt::format("a list of {}", item.items.size()), form);
    auto& component = values.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      read_value(component_fields[i], item.items[i], join_path(item_path, component_fields[i].key), component[i]);
  }
}

void read_value(const Field& field, const ConfigNode& node, const std::string& path,
                std::map<std::string, double>& values) {
  require_map(node, path);
  for (const ConfigNode::Entry& entry : node.entries)
    read_value(field, entry.value, join_path(path, entry.key), values[entry.key]);
}

void SectionReader::read_one(const Field& field, ConfigNode& node, const std::string& node_path,
                             std::vector<ReferenceSpec>& parts) const {
  parts.clear();
  require_list(field, node, node_path, "references");
  for (ConfigNode& item : node.items) {
    const std::string item_path = join_path(node_path, std::to_string(parts.size()));
    ReferenceSpec& part = parts.emplace_back();
    context.errors.collect([&] { read_reference(item, item_path, part, context); });
  }
}

void read_reference(ConfigNode& node, const std::string& path, ReferenceSpec& reference, ReadContext& context) {
  require_map(node, path);
  reference = {};
  const Field kind{"kind", "", 0, 0, "", Presence::required, reference_kind_names};
  const ConfigNode::Entry* entry = node.find("kind");
  std::vector<Field> fields{kind};
  if (entry == nullptr) {
    for (const ConfigNode::Entry& other : node.entries)
      if (!near_names(other.key, {"kind"}).empty())
        refuse(other.origin, join_path(path, other.key), "an unknown key", expected_keys(other.key, fields));
    refuse_missing(node, path, kind, expected_choice(kind));
  }
  read_value(kind, entry->value, join_path(path, "kind"), reference.kind);
  reference.smoothness = default_smoothness(reference.kind);
  fields.clear();
  visit_reference(reference.kind, FieldCollector{fields});
  std::set<std::string> excused = translate_data_sheet(node, path, fields, context);
  tell_unknown_keys(node, path, fields, context, excused);
  visit_reference(reference.kind, SectionReader{node, path, context, false, &excused}, reference);
}

void require_map(const ConfigNode& node, const std::string& path) {
  if (node.type != Type::map) refuse(node.origin, path.empty() ? "(top)" : path, describe(node), "a map of keys");
}

void tell_unknown_keys(const ConfigNode& map, const std::string& path, const std::vector<Field>& fields,
                       ReadContext& context, std::set<std::string>& excused) {
  std::vector<std::string> keys;
  for (const Field& field : fields) keys.emplace_back(field.key);
  for (const ConfigNode::Entry& entry : map.entries) {
    const auto known = [&](const Field& field) { return field.key == entry.key; };
    if (std::any_of(fields.begin(), fields.end(), known)) continue;
    if (const Field* meant = field_of_other_unit(entry.key, fields)) excused.emplace(meant->key);
    const std::vector<std::string> near = near_names(entry.key, keys);
    if (!near.empty()) excused.insert(near.front());
    context.errors.collect(
        [&] { refuse(entry.origin, join_path(path, entry.key), "an unknown key", expected_keys(entry.key, fields)); });
  }
}

void refuse_missing(const ConfigNode& map, const std::string& path, const Field& field, const std::string& what) {
  refuse(map.origin, join_path(path, field.key), "nothing", what);
}

}  // namespace pneuservo
