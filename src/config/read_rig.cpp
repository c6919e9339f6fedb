// Reads a config file into a Rig; every mistake in it is one sentence with file, line, key, found and expected.
#include "config/read_rig.hpp"

#include <optional>
#include <set>

#include <fmt/format.h>

#include "config/effects_reader.hpp"
#include "config/reference_checks.hpp"
#include "config/rig_checks.hpp"
#include "config/section_reader.hpp"
#include "config/valve_table.hpp"

namespace pneuservo {

namespace {

template <class T>
inline constexpr bool holds_effects =
    std::is_same_v<T, AxisEffects<double>> || std::is_same_v<T, VesselEffects<double>>;

/// All sections but `effects` and `concealed`.
struct RigReader {
  SectionReader section;
  template <class T> void operator()(const Field& field, T& value) const {
    if constexpr (!holds_effects<T>) {
      if (field.key != "concealed") section(field, value);
    }
  }
};

/// Those two, after the others: the sensors that a rig has say which effects there are.
struct EffectsReader {
  Rig& rig;
  ConfigNode& root;
  InputErrors& errors;
  template <class T> void operator()(const Field& field, T&) const {
    const bool is_concealed = field.key == "concealed";
    if (!holds_effects<T> && !is_concealed) return;
    ConfigNode::Entry* entry = root.find(std::string(field.key));
    if (entry == nullptr) return;
    const auto read = is_concealed ? read_concealed : read_effects;
    errors.collect([&] { read(entry->value, std::string(field.key), rig, errors); });
  }
};

/// Relative paths that the file (not a --set) states count from the file's folder.
void anchor_paths(ReferenceSpec& reference, const ConfigNode& node, const std::filesystem::path& folder) {
  const ConfigNode::Entry* path = node.find("path");
  const bool from_file = path != nullptr && !path->value.origin.starts_with("--set");
  if (from_file && std::filesystem::path(reference.path).is_relative())
    reference.path = std::filesystem::absolute(folder / reference.path).lexically_normal().string();
  const ConfigNode::Entry* parts = node.find("parts");
  for (std::size_t i = 0; parts != nullptr && i < reference.parts.size(); ++i)
    anchor_paths(reference.parts[i], parts->value.items[i], folder);
}

/// The same for the files of the nodes on a bus and of a board.
void anchor_device_files(Rig& rig, const std::filesystem::path& folder) {
  const auto anchor = [&](std::string& path) {
    if (!path.empty() && std::filesystem::path(path).is_relative())
      path = std::filesystem::absolute(folder / path).lexically_normal().string();
  };
  if (rig.hal && rig.hal->comedi) anchor(rig.hal->comedi->calibration);
  if (!rig.hal || !rig.hal->can) return;
  for (auto& [name, node] : rig.hal->can->nodes) anchor(node.eds);
}

/// All keys of the file; what another kind of rig or format would read is told alone.
void read_keys(ConfigNode& root, Rig& rig, InputErrors& errors) {
  const std::string top;
  translate_valve_table(root, errors);
  errors.throw_if_any();
  ReadContext context{rig, errors};
  Rig::visit(RigReader{{root, top, context, true}}, rig);
  errors.throw_if_any();
  if (rig.has_controller()) check_choice_of_law(rig.kind, root, errors);
  const std::vector<Field> fields = fields_of(rig);
  std::set<std::string> excused = translate_data_sheet(root, top, fields, context);
  tell_unknown_keys(root, top, fields, context, excused);
  for (const std::string& key : excused)
    if (root.find(key) == nullptr) errors.doubt(key);
  Rig::visit(RigReader{{root, top, context, false, &excused}}, rig);
  Rig::visit(EffectsReader{rig, root, errors}, rig);
}

Rig rig_from_tree(ConfigNode root, const std::vector<std::string>& overrides,
                  const std::optional<std::filesystem::path>& anchor, ConfigUse use) {
  require_map(root, "");
  InputErrors errors;
  for (const std::string& override_text : overrides) errors.collect([&] { apply_override(root, override_text); });
  errors.throw_if_any();
  Rig rig;
  read_keys(root, rig, errors);
  const ConfigNode::Entry* reference = root.find("reference");
  if (anchor && reference != nullptr && !errors.concern("reference"))
    anchor_paths(rig.reference, reference->value, *anchor);
  if (anchor) anchor_device_files(rig, *anchor);
  if (!errors.concern("reference")) errors.collect([&] { complete_rig(rig, root); });
  check_rig(rig, root, errors);
  if (use == ConfigUse::machine) errors.collect([&] { check_machine_rig(rig, root); });
  errors.throw_if_any();
  return rig;
}

}  // namespace

Rig read_rig(const std::filesystem::path& file, const std::vector<std::string>& overrides, ConfigUse use) {
  return rig_from_tree(read_config_tree(file, "a config file (docs/config-keys.md)"), overrides, file.parent_path(),
                       use);
}

Rig parse_rig(const std::string& yaml_text, const std::string& source_name, const std::vector<std::string>& overrides) {
  return rig_from_tree(parse_config_tree(yaml_text, source_name), overrides, {}, ConfigUse::simulation);
}

ReferenceSpec parse_reference(const std::string& yaml_text, const std::string& source_name) {
  ConfigNode root = parse_config_tree(yaml_text, source_name);
  ReferenceSpec reference;
  InputErrors errors;
  const Rig no_rig;
  ReadContext context{no_rig, errors};
  errors.collect([&] { read_reference(root, "reference", reference, context); });
  errors.throw_if_any();
  check_reference_keys(reference, root, "reference");
  return reference;
}

}  // namespace pneuservo
