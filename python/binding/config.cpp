// The config as an object of Python: read, looked into, changed into a new one.
#include <fmt/format.h>

#include "../fmu/variables.hpp"
#include "binding.hpp"
#include "config/dump_rig.hpp"
#include "config/effects_reader.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "config/rig_parameters.hpp"

namespace pneuservo::python {
namespace {

/// Keys of what a document states.
Document document_of(const ConfigNode& node) { return nb::borrow<Document>(python_value(node)); }

ConfigNode tree_of(const Config& config) { return parse_config_tree(dump_rig(config.rig), config.source); }

Config changed(const Config& config, nb::handle changes) {
  return {parse_rig(dump_rig(config.rig), config.source, overrides_of(changes)), config.source};
}

/// What stands at a path such as line_1.length_m.
Anything at_path(const Config& config, const std::string& path) {
  const ConfigNode root = tree_of(config);
  const ConfigNode* node = &root;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const ConfigNode::Entry* entry = node->find(path.substr(begin, end - begin));
    if (entry == nullptr) {
      // A number that is not stated has its neutral value; the library names near keys where there is none.
      try {
        return nb::borrow<Anything>(nb::cast(get_parameter(config.rig, path)));
      } catch (const InputError& error) { throw nb::key_error(error.what()); }
    }
    node = &entry->value;
    begin = end + 1;
  }
  return nb::borrow<Anything>(python_value(*node));
}

Document parameters(const Config& config) {
  Document out;
  for (const ParameterPath& p : parameter_paths(config.rig)) {
    nb::dict one;
    one["value"] = p.value;
    one["unit"] = std::string(p.field.unit);
    one["minimum"] = p.field.minimum;
    one["maximum"] = p.field.maximum;
    one["help"] = std::string(p.field.help);
    out[nb::cast(p.path)] = one;
  }
  return out;
}

nb::list fmu_variables(const Config& config, const std::string& model) {
  nb::list out;
  for (const fmu::Variable& v : fmu::variables_of(config.rig, fmu::model_named(model))) {
    nb::dict one;
    one["name"] = v.name;
    one["reference"] = v.reference;
    one["causality"] = std::string(fmu::name_of(v.causality));
    one["unit"] = v.unit;
    one["help"] = v.help;
    one["start"] = v.start;
    one["minimum"] = v.minimum;
    one["maximum"] = v.maximum;
    out.append(one);
  }
  return out;
}

Config with_effects(const Config& config, const Document& effects) {
  nb::dict changes;
  for (const auto& [name, keys] : effects) {
    if (!nb::isinstance<nb::str>(name))
      throw nb::type_error(fmt::format("effects: found {}, expected names as text", type_text(name)).c_str());
    changes[nb::str("effects.") + nb::str(name)] = keys;
  }
  return changed(config, changes);
}

}  // namespace

void bind_config(nb::module_& m) {
  nb::class_<Config>(m, "Config",
                     "A rig as a config file states it. It never changes: replace() gives a new one.\n\n"
                     "Raises InputError with a sentence for each mistake: file, line, key, found, expected.")
      .def(
          "__init__",
          [](Config* self, const nb::object& path, const nb::object& changes) {
            const auto file = nb::cast<std::string>(nb::str(path));
            new (self) Config{read_rig(file, overrides_of(changes), ConfigUse::simulation), file};
          },
          nb::arg("path"), nb::arg("changes") = nb::none(),
          "Reads a file. changes: {\"line_1.length_m\": 5} or [\"line_1.length=5 m\"], as the program's --set.")
      .def_static(
          "from_text",
          [](const std::string& text, const std::string& name, const nb::object& changes) {
            return Config{parse_rig(text, name, overrides_of(changes)), name};
          },
          nb::arg("text"), nb::arg("name") = "text", nb::arg("changes") = nb::none(),
          "The same from text; name stands for the file in errors.")
      .def("replace", &changed, nb::arg("changes"), "A new config with other values, by their paths.")
      .def("with_effects", &with_effects, nb::arg("effects"),
           "A new config with physics switched on by name: {\"chamber_leak_1\": {\"area_m2\": 2e-8}}.")
      .def("__getitem__", &at_path, nb::arg("path"),
           "What stands at a path: a number in the unit of its key, a word, a dict.")
      .def(
          "to_dict", [](const Config& c) { return document_of(tree_of(c)); }, "Every key as dicts, lists and numbers.")
      .def(
          "to_yaml", [](const Config& c) { return dump_rig(c.rig); },
          "Every key with unit, range and meaning; reads back to the same config, bit for bit.")
      .def("parameters", &parameters, "Every number by its path: value, unit, minimum, maximum, help.")
      .def(
          "effect_names", [](const Config& c) { return effect_names(c.rig); }, "Names that with_effects() takes.")
      .def_prop_ro("name", [](const Config& c) { return c.rig.name; })
      .def_prop_ro(
          "source", [](const Config& c) { return c.source; }, "File or name that errors state.")
      .def_prop_ro(
          "kind", [](const Config& c) { return std::string(info(c.rig.kind).name); }, "Kind of rig.")
      .def_prop_ro(
          "period_s", [](const Config& c) { return c.rig.period_s; }, "Period of the loop [s].")
      .def_prop_ro(
          "duration_s", [](const Config& c) { return c.rig.duration_s; }, "Duration of a run [s].")
      .def_prop_ro(
          "valves", [](const Config& c) { return c.rig.valves(); }, "Proportional valves: 1 or 2; 0: none.")
      .def("__repr__",
           [](const Config& c) { return fmt::format("<pneuservo.Config {} from {}>", c.rig.name, c.source); })
      .def("__getstate__", [](const Config& c) { return std::pair(dump_rig(c.rig), c.source); })
      .def("__setstate__", [](Config& c, const std::pair<std::string, std::string>& state) {
        new (&c) Config{parse_rig(state.first, state.second), state.second};
      });
  m.def("_fmu_variables", &fmu_variables, nb::arg("config"), nb::arg("model"), "For pneuservo.fmu.");
}

}  // namespace pneuservo::python
