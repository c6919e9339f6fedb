// Verb `effects`: the vocabulary of effects, with what a diagnosis and its tools know of each.
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/read_rig.hpp"
#include "diagnosis/search/effect_scales.hpp"
#include "elements/effect_entry.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "report/diagnosis_words.hpp"
#include "report/table.hpp"

namespace pneuservo {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array role_names{"law", "description", "granted", "disturbance", "played", "table"};
constexpr std::array variation_names{"linear", "logarithmic", "inverse_square"};
constexpr std::array growth_names{"held", "twice", "narrower"};
constexpr std::array excitation_names{"many_speeds", "both_ways", "places_again", "a_radian"};
/// In the order of EffectScale.
constexpr std::array scale_names{"one",
                                 "force",
                                 "force_per_pressure",
                                 "force_per_speed",
                                 "drag",
                                 "stiffness",
                                 "valve_area",
                                 "valve_area_per_pressure",
                                 "inverse_valve_area",
                                 "inverse_bore_area",
                                 "moving_mass",
                                 "top_speed",
                                 "half_stroke",
                                 "line_volume",
                                 "wall_heat",
                                 "laminar_conductance",
                                 "channel_offset",
                                 "channel_gain",
                                 "viscosity",
                                 "adiabatic_change",
                                 "supply_resistance",
                                 "supply_pressure",
                                 "stroke",
                                 "duration"};
static_assert(scale_names.size() == static_cast<std::size_t>(EffectScale::duration) + 1);

template <class E> const char* name_of(const auto& names, E value) { return names[static_cast<std::size_t>(value)]; }

struct EffectsOptions {
  std::string config, json;
};

/// An effect by its name in a config, with its keys and their neutral values.
struct NamedEffect {
  std::string name;
  const EffectEntry* entry;
  std::vector<std::pair<Field, double>> keys;

  double neutral(std::string_view key) const {
    const auto found = std::find_if(keys.begin(), keys.end(), [&](const auto& k) { return k.first.key == key; });
    return found->second;
  }
};

/// Takes each effect of a visit once.
struct EffectCollector {
  std::vector<NamedEffect>& found;
  std::string channel;  ///< of a sensor's effects

  template <class Effect> void operator()(const Field& field, const Effect&) const {
    const std::string name = std::string(field.key) + (channel.empty() ? "" : ":" + channel);
    if (std::any_of(found.begin(), found.end(), [&](const NamedEffect& e) { return e.name == name; })) return;
    NamedEffect out{name, find_effect(name), {}};
    const Effect none;
    Effect::visit([&](const Field& key, double value) { out.keys.emplace_back(key, value); }, none);
    found.push_back(std::move(out));
  }
};

/// Those that a rig can have, or any rig; in the order of the vocabulary.
std::vector<NamedEffect> named_effects(const std::optional<Rig>& rig) {
  std::vector<NamedEffect> out;
  const EffectCollector collect{out, ""};
  if (rig) {
    visit_effects(*rig, collect);
  } else {
    const AxisEffects<double> axis;
    const VesselEffects<double> vessel;
    AxisEffects<double>::visit(collect, axis);
    VesselEffects<double>::visit(collect, vessel);
  }
  const SensorEffects<double> none;
  for (const Signal signal : all_signals)
    if (!rig || rig->has_sensor(signal))
      SensorEffects<double>::visit(EffectCollector{out, std::string(info(signal).name)}, none);
  const auto& order = all_effects();
  const auto place = [&](const NamedEffect& e) { return std::find(order.begin(), order.end(), e.entry); };
  std::stable_sort(out.begin(), out.end(),
                   [&](const NamedEffect& a, const NamedEffect& b) { return place(a) < place(b); });
  return out;
}

Json key_json(const NamedEffect& effect, const Field& key, double neutral) {
  Json out{{"key", key.key}, {"unit", key.unit}, {"help", key.help}, {"neutral", neutral}};
  const auto& traits = effect.entry->parameters;
  const auto trait = std::find_if(traits.begin(), traits.end(), [&](const auto& t) { return t.key == key.key; });
  if (trait == traits.end()) return out;
  out["prior"] = {{"scale", name_of(scale_names, trait->scale)},
                  {"spread", trait->spread},
                  {"varied", name_of(variation_names, trait->variation)},
                  {"reporting_limit", trait->negligible},
                  {"starts", trait->grid}};
  if (trait->small_spread > 0) {
    out["of_every_machine"] = trait->small_spread;
    out["of_every_machine_scale"] = name_of(scale_names, trait->small_scale);
  }
  return out;
}

/// First rung of a ladder of machines; in numbers where there is a rig to take them from.
Json smallest_json(const NamedEffect& effect, const std::optional<Rig>& rig) {
  Json out = Json::object();
  for (const StatedSize& size : effect.entry->smallest) {
    const MotionRange at_rest{};
    Json one{{"value", rig ? size.value * ScaleTable{*rig, at_rest}(size.scale) : size.value},
             {"neutral", effect.neutral(size.key)},
             {"growth", name_of(growth_names, size.growth)},
             {"scale", name_of(scale_names, size.scale)}};
    out[std::string(size.key)] = std::move(one);
  }
  return out;
}

Json signature_json(const NamedEffect& effect) {
  for (const EffectSignature& s : effect.entry->signatures) {
    if (s.side != split_effect(effect.name).side) continue;
    Json sizes = Json::object(), channels = Json::array();
    for (const StatedSize& size : s.sizes) sizes[std::string(size.key)] = size.value;
    for (const Signal channel : s.channels) channels.push_back(info(channel).name);
    return {{"sizes", sizes}, {"words", s.words}, {"channels", channels}, {"against", s.against}};
  }
  return nullptr;
}

Json effect_json(const NamedEffect& effect, const std::optional<Rig>& rig) {
  const EffectEntry& entry = *effect.entry;
  Json shown_by = Json::array(), keys = Json::array();
  for (std::size_t i = 0; i < excitation_names.size(); ++i)
    if (entry.shown_by & (1U << i)) shown_by.push_back(excitation_names[i]);
  for (const auto& [key, neutral] : effect.keys) keys.push_back(key_json(effect, key, neutral));
  return {{"name", effect.name},
          {"words", effect_words(effect.name)},
          {"element", on_side_of(entry.element, effect.name)},
          {"family", on_side_of(entry.family, effect.name)},
          {"role", name_of(role_names, entry.role)},
          {"of_every_machine", std::any_of(entry.parameters.begin(), entry.parameters.end(),
                                           [](const ParameterTrait& t) { return t.small_spread > 0; })},
          {"contains", entry.contains.name},
          {"over", entry.over},
          {"shown_by", std::move(shown_by)},
          {"keys", std::move(keys)},
          {"smallest", smallest_json(effect, rig)},
          {"signature", signature_json(effect)}};
}

std::string effects_text(const std::vector<NamedEffect>& effects) {
  std::vector<std::string> names, words, places, keys;
  for (const NamedEffect& effect : effects) {
    names.push_back(effect.name);
    words.push_back(effect_words(effect.name));
    places.push_back(on_side_of(effect.entry->element, effect.name));
    std::vector<std::string_view> own;
    for (const auto& [key, neutral] : effect.keys) own.push_back(key.key);
    // A table's points have a number each.
    const bool is_table = effect.entry->role == EffectRole::table;
    const std::size_t half = own.size() / 2;
    keys.push_back(is_table ? fmt::format("{} to {}, {} to {}", own.front(), own[half - 1], own[half], own.back())
                            : fmt::format("{}", fmt::join(own, ", ")));
  }
  return text_table({"",
                     {text_column("effect", names), text_column("what", words), text_column("element", places),
                      text_column("keys", keys)}});
}

void print_effects(const EffectsOptions& options) {
  OutputFiles().reads("CONFIG", options.config).writes("--json", options.json, ResultKind::json);
  std::optional<Rig> rig;
  if (!options.config.empty()) rig = read_rig(options.config);
  const std::vector<NamedEffect> effects = named_effects(rig);
  Json all = Json::array();
  for (const NamedEffect& effect : effects) all.push_back(effect_json(effect, rig));
  if (options.json != "-") std::fputs(effects_text(effects).c_str(), stdout);
  write_json(options.json, Json{{"effects", std::move(all)}});
}

}  // namespace

void add_effects(CommandLine& app, int&) {
  auto options = std::make_shared<EffectsOptions>();
  Verb verb = app.add_verb("effects", "the effects that a config can have and a diagnosis looks for");
  verb.add_option("CONFIG", options->config, "those of this rig, sizes in its numbers; else all");
  verb.add_option("--json", options->json, "with priors, reporting limits and sizes, as JSON; - for standard output");
  verb.callback([options] { print_effects(*options); });
}

}  // namespace pneuservo
