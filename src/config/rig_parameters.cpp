// All numbers of a rig by their config path (line_1.length_m, effects.sensor_offset:x.offset), from the same fields.
#include "config/rig_parameters.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include <pneuservo/rig/pressure_axis.hpp>

#include "config/input_error.hpp"
#include "config/reference_fields.hpp"
#include "config/section_reader.hpp"

namespace pneuservo {

namespace {

/// A number as a walk meets it: one of both.
struct WalkedNumber {
  const double* plain = nullptr;
  const std::optional<double>* optional = nullptr;

  bool is_stated() const { return plain != nullptr || optional->has_value(); }
  double value() const { return plain != nullptr ? *plain : **optional; }
  /// For rigs that are not constant themselves; the walk, compiled once, takes all as constant.
  void set(double to) const {
    if (plain != nullptr) *const_cast<double*>(plain) = to;
    else *const_cast<std::optional<double>*>(optional) = to;
  }
};
using OnNumber = std::function<void(const std::string& path, const Field&, const WalkedNumber&)>;

/// Calls `on` for every double and optional double below the visited sections.
struct NumberWalker {
  const OnNumber& on;
  std::string prefix;

  void operator()(const Field& field, const double& value) const { on(join_path(prefix, field.key), field, {&value}); }
  void operator()(const Field& field, const std::optional<double>& value) const {
    on(join_path(prefix, field.key), field, {nullptr, &value});
  }
  void operator()(const Field& field, const ReferenceSpec& value) const {
    walk_reference(join_path(prefix, field.key), value);
  }
  template <class T> void operator()(const Field& field, const T& value) const {
    if constexpr (ParameterSection<T>) T::visit(NumberWalker{on, join_path(prefix, field.key)}, value);
  }
  template <ParameterSection T> void operator()(const Field& field, const std::optional<T>& value) const {
    if (value) T::visit(NumberWalker{on, join_path(prefix, field.key)}, *value);
  }
  void walk_reference(const std::string& path, const ReferenceSpec& reference) const {
    const NumberWalker below{on, path};
    visit_reference(reference.kind, below, reference);
    for (std::size_t i = 0; i < reference.parts.size(); ++i)
      walk_reference(fmt::format("{}.parts.{}", path, i), reference.parts[i]);
  }
};

/// Walks a rig; the effects of the sensors follow those of the axis.
struct RigWalker {
  const Rig& rig;
  const OnNumber& on;

  template <class T> void operator()(const Field& field, const T& value) const {
    if (field.key == "hal" || field.key == "serve") return;  // wiring, nothing of the physics
    if (field.key != "effects") return NumberWalker{on, ""}(field, value);
    visit_effects(rig, NumberWalker{on, "effects"});
    for (const Signal signal : all_signals) {
      if (!rig.has_sensor(signal)) continue;
      const auto walk = [&](const Field& effect, const auto& parameters) {
        std::remove_cvref_t<decltype(parameters)>::visit(
            NumberWalker{on, fmt::format("effects.{}:{}", effect.key, info(signal).name)}, parameters);
      };
      SensorEffects<double>::visit(walk, rig.sensor_effects[signal]);
    }
  }
};

void walk_numbers(const Rig& rig, const OnNumber& on) { Rig::visit(RigWalker{rig, on}, rig); }

[[noreturn]] void refuse_path(const Rig& rig, std::string_view path) {
  std::vector<std::string> known;
  walk_numbers(rig, [&](const std::string& name, const Field&, const WalkedNumber&) { known.push_back(name); });
  std::vector<std::string> near = near_names(path, known);
  throw InputError(fmt::format("parameter {}: found no such number in rig '{}', expected {}", path, rig.name,
                               near.empty() ? "a path such as slider.mass_kg"
                                            : fmt::format("a known path (did you mean {}?)", fmt::join(near, ", "))));
}

/// The number at a path with its field; no number: the rig has no such path.
std::pair<Field, WalkedNumber> find_number(const Rig& rig, std::string_view path) {
  std::pair<Field, WalkedNumber> found;
  walk_numbers(rig, [&](const std::string& name, const Field& field, const WalkedNumber& number) {
    if (name == path) found = {field, number};
  });
  return found;
}

}  // namespace

ParameterHandle::ParameterHandle(const Rig& rig, std::string_view path) : path_(path) {
  const auto [field, number] = find_number(rig, path);
  if (number.plain == nullptr && number.optional == nullptr) refuse_path(rig, path);
  field_ = field;
  is_optional_ = number.optional != nullptr;
  const void* place = is_optional_ ? static_cast<const void*>(number.optional) : number.plain;
  const auto first = reinterpret_cast<std::uintptr_t>(&rig), at = reinterpret_cast<std::uintptr_t>(place);
  is_inside_ = at >= first && at < first + sizeof(Rig);
  if (is_inside_) offset_ = at - first;
}

namespace {

WalkedNumber number_in(const Rig& rig, std::size_t offset, bool is_optional) {
  const std::byte* place = reinterpret_cast<const std::byte*>(&rig) + offset;
  if (is_optional) return {nullptr, reinterpret_cast<const std::optional<double>*>(place)};
  return {reinterpret_cast<const double*>(place)};
}

}  // namespace

double ParameterHandle::value(const Rig& rig) const {
  const WalkedNumber number = is_inside_ ? number_in(rig, offset_, is_optional_) : find_number(rig, path_).second;
  if (!number.is_stated()) refuse_path(rig, path_);
  return number.value();
}

void ParameterHandle::set(Rig& rig, double value) const {
  // Words are made only for what may have to be refused.
  if (!(value >= field_.minimum && value <= field_.maximum))
    require_in_range(field_, value, "parameter", path_, fmt::format("{}", value));
  (is_inside_ ? number_in(rig, offset_, is_optional_) : find_number(rig, path_).second).set(value);
}

std::vector<ParameterPath> parameter_paths(const Rig& rig) {
  std::vector<ParameterPath> paths;
  walk_numbers(rig, [&](const std::string& path, const Field& field, const WalkedNumber& number) {
    if (number.is_stated()) paths.push_back({path, field, number.value()});
  });
  return paths;
}

bool has_parameter(const Rig& rig, std::string_view path) {
  const WalkedNumber number = find_number(rig, path).second;
  return number.plain != nullptr || number.optional != nullptr;
}

double get_parameter(const Rig& rig, std::string_view path) { return ParameterHandle(rig, path).value(rig); }

void set_parameter(Rig& rig, std::string_view path, double value) { ParameterHandle(rig, path).set(rig, value); }

Rig simulated_rig(const Rig& rig) {
  Rig simulated = rig;
  if (rig.deviations.empty() && rig.concealed.empty()) return simulated;
  walk_numbers(simulated, [&](const std::string& name, const Field&, const WalkedNumber& number) {
    const auto found = rig.deviations.find(name);
    if (found != rig.deviations.end() && number.is_stated()) number.set(number.value() * (1.0 + found->second));
    const auto instead = rig.concealed.find(name);
    if (instead != rig.concealed.end()) number.set(instead->second);
  });
  lay_out_pressure_axis(simulated);
  return simulated;
}

void without_effects(Rig& rig) {
  rig.axis.effects = {};
  rig.vessel_effects = {};
  rig.sensor_effects = {};
}

}  // namespace pneuservo
