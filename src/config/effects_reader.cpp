// The sections `effects` and `concealed`: physics by name, on the axis and on its sensors (sensor_offset:x).
#include "config/effects_reader.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "config/rig_parameters.hpp"
#include "config/section_reader.hpp"

namespace pneuservo {

namespace {

/// Reads the one effect of a visit whose name is `name`.
struct NamedEffectReader {
  const std::string& name;
  ConfigNode& node;
  const std::string& path;
  ReadContext& context;
  template <class Effect> void operator()(const Field& field, Effect& effect) const {
    if (field.key == name) read_section(node, path, effect, context);
  }
};

}  // namespace

std::vector<std::string> effect_names(const Rig& rig) {
  std::vector<std::string> names;
  const auto add = [&](const Field& field, const auto&) { names.emplace_back(field.key); };
  visit_effects(rig, add);
  for (const Field& field : fields_of(SensorEffects<double>{}))
    for (const Signal signal : all_signals)
      if (rig.has_sensor(signal)) names.push_back(fmt::format("{}:{}", field.key, info(signal).name));
  return names;
}

void read_effects(ConfigNode& node, const std::string& path, Rig& rig, InputErrors& errors) {
  require_map(node, path);
  const std::vector<std::string> known = effect_names(rig);
  ReadContext context{rig, errors};
  const auto read = [&](ConfigNode::Entry& entry) {
    const std::string full = join_path(path, entry.key);
    if (std::find(known.begin(), known.end(), entry.key) == known.end())
      refuse(entry.origin, full, "an unknown effect", expected_names(entry.key, known));
    const std::size_t colon = entry.key.find(':');
    const std::string name = entry.key.substr(0, colon);
    const NamedEffectReader reader{name, entry.value, full, context};
    if (colon == std::string::npos) visit_effects(rig, reader);
    else SensorEffects<double>::visit(reader, rig.sensor_effects[signal_named(entry.key.substr(colon + 1)).value()]);
  };
  for (ConfigNode::Entry& entry : node.entries) errors.collect([&] { read(entry); });
}

void read_concealed(ConfigNode& node, const std::string& path, Rig& rig, InputErrors& errors) {
  Rig machine = rig;
  without_effects(machine);
  read_effects(node, path, machine, errors);
  for (const ParameterPath& parameter : parameter_paths(machine))
    for (const ConfigNode::Entry& entry : node.entries)
      if (parameter.path.starts_with(fmt::format("effects.{}.", entry.key)))
        rig.concealed[parameter.path] = parameter.value;
}

}  // namespace pneuservo
