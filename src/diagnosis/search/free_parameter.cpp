// One number of a hypothesis that a fit may move, in units of its prior's standard deviation.
#include "diagnosis/search/free_parameter.hpp"

#include <algorithm>
#include <string_view>

namespace pneuservo {

const ParameterTrait* trait_of(const std::string& path) {
  constexpr std::string_view effects = "effects.";
  const std::size_t dot = path.rfind('.');
  if (!path.starts_with(effects) || dot < effects.size()) return nullptr;
  const EffectEntry* entry = find_effect(path.substr(effects.size(), dot - effects.size()));
  if (entry == nullptr) return nullptr;
  const auto found = std::ranges::find(entry->parameters, std::string_view(path).substr(dot + 1), &ParameterTrait::key);
  return found == entry->parameters.end() ? nullptr : found;
}

FreeParameter free_number(const Rig& rig, const std::string& path) {
  FreeParameter out;
  out.path = path;
  out.number.emplace(rig, path);
  const ParameterTrait* trait = trait_of(path);
  if (trait != nullptr && trait->has_valleys) out.valleys_apart = rig.period_s;
  return out;
}

Hypothesis with_parameters(const Hypothesis& base, const std::vector<FreeParameter>& parameters,
                           const std::vector<double>& z) {
  Hypothesis hypothesis = base;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const FreeParameter& parameter = parameters[i];
    const double value = parameter.value(z[i]);
    if (parameter.is_of_recording()) parameter.of_recording(hypothesis) = value;
    else parameter.number.value().set(hypothesis.rig, value);
  }
  return hypothesis;
}

}  // namespace pneuservo
