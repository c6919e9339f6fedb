// The vocabulary of effects as one list, found by name.
#include "elements/effect_entry.hpp"

#include <algorithm>

namespace pneuservo {

EffectName split_effect(std::string_view name) {
  if (const std::size_t colon = name.find(':'); colon != std::string_view::npos)
    return {name.substr(0, colon), name.substr(colon + 1), true};
  if (name.ends_with("_1") || name.ends_with("_2"))
    return {name.substr(0, name.size() - 2), name.substr(name.size() - 1), false};
  return {name, {}, false};
}

std::string on_side_of(std::string_view whole, std::string_view effect) {
  const EffectName name = split_effect(effect);
  return name.side.empty() ? std::string(whole)
                           : std::string(whole) + (name.is_of_sensor ? ":" : "_") + std::string(name.side);
}

const std::vector<const EffectEntry*>& all_effects() {
  static const std::vector<const EffectEntry*> all = [] {
    std::vector<const EffectEntry*> out;
    for (const auto entries :
         {motion_effect_entries(), pneumatic_effect_entries(), vessel_effect_entries(), sensor_effect_entries()})
      for (const EffectEntry& entry : entries) out.push_back(&entry);
    return out;
  }();
  return all;
}

const EffectEntry* find_effect(std::string_view name) {
  const std::string_view base = split_effect(name).base;
  const auto& all = all_effects();
  const auto found = std::find_if(all.begin(), all.end(), [&](const EffectEntry* e) { return e->name == base; });
  return found == all.end() ? nullptr : *found;
}

}  // namespace pneuservo
