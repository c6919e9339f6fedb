// All numbers of a rig by their config path (line_1.length_m, effects.sensor_offset:x.offset), from the same fields.
#include "config/rig_parameters.hpp"

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/reference_fields.hpp"
#include "config/section_reader.hpp"

namespace pneuservo {

namespace {

/// Calls visit(path, field, number) for every double and optional double below the visited sections.
template <class Visit> struct NumberWalker {
  const Visit& visit;
  std::string prefix;

  template <class T> void operator()(const Field& field, T& value) const {
    using Plain = std::remove_const_t<T>;
    const auto path = [&] { return join_path(prefix, field.key); };
    constexpr bool is_number = std::is_same_v<Plain, double> || std::is_same_v<Plain, std::optional<double>>;
    if constexpr (is_number) visit(path(), field, value);
    else if constexpr (std::is_same_v<Plain, ReferenceSpec>) walk_reference(path(), value);
    else if constexpr (ParameterSection<Plain>) Plain::visit(NumberWalker{visit, path()}, value);
  }
  template <ParameterSection T> void operator()(const Field& field, std::optional<T>& value) const {
    if (value) T::visit(NumberWalker{visit, join_path(prefix, field.key)}, *value);
  }
  template <ParameterSection T> void operator()(const Field& field, const std::optional<T>& value) const {
    if (value) T::visit(NumberWalker{visit, join_path(prefix, field.key)}, *value);
  }
  template <class Reference> void walk_reference(const std::string& path, Reference& reference) const {
    const NumberWalker below{visit, path};
    visit_reference(reference.kind, below, reference);
    for (std::size_t i = 0; i < reference.parts.size(); ++i)
      walk_reference(fmt::format("{}.parts.{}", path, i), reference.parts[i]);
  }
};

/// Walks a rig; the effects of the sensors follow those of the axis.
template <class RigType, class Visit> void walk_numbers(RigType& rig, const Visit& visit) {
  RigType::visit(
      [&](const Field& field, auto& value) {
        if (field.key == "hal" || field.key == "serve") return;  // wiring, nothing of the physics
        if (field.key != "effects") return NumberWalker<Visit>{visit, ""}(field, value);
        visit_effects(rig, NumberWalker<Visit>{visit, "effects"});
        for (const Signal signal : all_signals) {
          if (!rig.has_sensor(signal)) continue;
          SensorEffects<double>::visit(
              [&](const Field& effect, auto& parameters) {
                using Effect = std::remove_cvref_t<decltype(parameters)>;
                const std::string path = fmt::format("effects.{}:{}", effect.key, info(signal).name);
                Effect::visit(NumberWalker<Visit>{visit, path}, parameters);
              },
              rig.sensor_effects[signal]);
        }
      },
      rig);
}

bool is_stated(double) { return true; }
bool is_stated(const std::optional<double>& value) { return value.has_value(); }
double stated_value(double value) { return value; }
double stated_value(const std::optional<double>& value) { return *value; }

[[noreturn]] void refuse_path(const Rig& rig, std::string_view path) {
  std::vector<std::string> known;
  walk_numbers(rig, [&](const std::string& name, const Field&, const auto&) { known.push_back(name); });
  std::vector<std::string> near = near_names(path, known);
  throw InputError(fmt::format("parameter {}: found no such number in rig '{}', expected {}", path, rig.name,
                               near.empty() ? "a path such as slider.mass_kg"
                                            : fmt::format("a known path (did you mean {}?)", fmt::join(near, ", "))));
}

}  // namespace

std::vector<ParameterPath> parameter_paths(const Rig& rig) {
  std::vector<ParameterPath> paths;
  walk_numbers(rig, [&](const std::string& path, const Field& field, const auto& value) {
    if (is_stated(value)) paths.push_back({path, field, stated_value(value)});
  });
  return paths;
}

bool has_parameter(const Rig& rig, std::string_view path) {
  bool found = false;
  walk_numbers(rig, [&](const std::string& name, const Field&, const auto&) { found = found || name == path; });
  return found;
}

double get_parameter(const Rig& rig, std::string_view path) {
  std::optional<double> found;
  walk_numbers(rig, [&](const std::string& name, const Field&, const auto& value) {
    if (name == path && is_stated(value)) found = stated_value(value);
  });
  if (!found) refuse_path(rig, path);
  return *found;
}

void set_parameter(Rig& rig, std::string_view path, double value) {
  bool found = false;
  walk_numbers(rig, [&](const std::string& name, const Field& field, auto& number) {
    if (name != path) return;
    found = true;
    require_in_range(field, value, "parameter", name, fmt::format("{}", value));
    number = value;
  });
  if (!found) refuse_path(rig, path);
}

Rig simulated_rig(const Rig& rig) {
  Rig simulated = rig;
  if (rig.deviations.empty()) return simulated;
  walk_numbers(simulated, [&](const std::string& name, const Field&, auto& number) {
    const auto found = rig.deviations.find(name);
    if (found != rig.deviations.end() && is_stated(number)) number = stated_value(number) * (1.0 + found->second);
  });
  return simulated;
}

}  // namespace pneuservo
