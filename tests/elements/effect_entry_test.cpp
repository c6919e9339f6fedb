// The vocabulary: an entry for each effect that a config can have, made of its own keys; what it draws acts on a plant.
#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include <pneuservo/elements/vessel_effects.hpp>
#include <pneuservo/rig/plant.hpp>

#include "elements/effect_entry.hpp"
#include "rig/nominal_axis.hpp"

using namespace pneuservo;

namespace {

struct NamedKeys {
  std::string name;
  std::vector<std::string> keys;
};

/// The effects of all rigs as configs name them, those of sensors without their channel.
std::vector<NamedKeys> effects_of_configs() {
  std::vector<NamedKeys> out;
  const auto take = [&out](const Field& field, const auto& effect) {
    NamedKeys named{std::string(field.key), {}};
    const auto add = [&named](const Field& key, double) { named.keys.emplace_back(key.key); };
    std::remove_cvref_t<decltype(effect)>::visit(add, effect);
    out.push_back(named);
  };
  const AxisEffects<double> axis;
  const VesselEffects<double> vessel;
  const SensorEffects<double> sensor;
  AxisEffects<double>::visit(take, axis);
  VesselEffects<double>::visit(take, vessel);
  SensorEffects<double>::visit(take, sensor);
  return out;
}

bool has(const NamedKeys& effect, std::string_view key) {
  return std::find(effect.keys.begin(), effect.keys.end(), key) != effect.keys.end();
}

/// Every key that an entry names.
std::vector<std::string_view> keys_named(const EffectEntry& entry) {
  std::vector<std::string_view> keys;
  for (const ParameterTrait& trait : entry.parameters) keys.push_back(trait.key);
  for (const StatedSize& size : entry.smallest) keys.push_back(size.key);
  for (const EffectSignature& signature : entry.signatures)
    for (const StatedSize& size : signature.sizes) keys.push_back(size.key);
  const SimplerLaw& simpler = entry.contains;
  for (const std::string_view key : {simpler.extra, simpler.beside, simpler.alike[0], simpler.alike[1]})
    if (!key.empty()) keys.push_back(key);
  return keys;
}

/// Sets keys of the effect of this name.
void set_effect(AxisEffects<double>& effects, std::string_view name, const EffectSignature& signature) {
  const auto set = [&](const Field& field, auto& effect) {
    if (field.key != name) return;
    std::remove_cvref_t<decltype(effect)>::visit(
        [&](const Field& key, double& value) {
          for (const StatedSize& size : signature.sizes)
            if (size.key == key.key) value = size.value;
        },
        effect);
  };
  AxisEffects<double>::visit(set, effects);
}

/// Position and port pressures of an axis that moves to and fro.
std::vector<double> course(const AxisParameters<double>& axis) {
  AxisPlant<double> plant;
  plant.configure(axis, 1e-3, 1.0);
  plant.reset({0.0, 470e3, 540e3});
  std::vector<double> out;
  for (int k = 0; k < 1500; ++k) {
    plant.step((k / 500) % 2 ? -1.0 : 1.0);
    out.insert(out.end(), {plant.position(), low(plant.port_pressure()), high(plant.port_pressure())});
  }
  return out;
}

}  // namespace

TEST_CASE("effects: every one of a config has an entry, and every entry is one of a config") {
  const std::vector<NamedKeys> effects = effects_of_configs();
  for (const NamedKeys& effect : effects) {
    INFO(effect.name);
    const EffectEntry* entry = find_effect(effect.name);
    REQUIRE(entry != nullptr);
    CHECK_FALSE(entry->words.empty());
    CHECK_FALSE(entry->element.empty());
    REQUIRE_FALSE(entry->parameters.empty());
    for (const std::string_view key : keys_named(*entry)) {
      INFO(key);
      CHECK(has(effect, key));
    }
    for (const ParameterTrait& trait : entry->parameters) CHECK(trait.spread > 0);
  }
  for (const EffectEntry* entry : all_effects()) {
    INFO(entry->name);
    CHECK(std::any_of(effects.begin(), effects.end(),
                      [&](const NamedKeys& e) { return split_effect(e.name).base == entry->name; }));
    CHECK(std::count_if(all_effects().begin(), all_effects().end(),
                        [&](const EffectEntry* e) { return e->name == entry->name; }) == 1);
  }
}

TEST_CASE("effects: what an entry says of another one holds of it") {
  for (const EffectEntry* entry : all_effects()) {
    INFO(entry->name);
    if (!entry->contains.name.empty()) {
      REQUIRE(find_effect(entry->contains.name) != nullptr);
      CHECK(find_effect(entry->contains.name)->family == entry->family);
      CHECK(entry->contains.extra.empty() != entry->contains.alike[0].empty());
    }
  }
}

TEST_CASE("effects: a name has its side or channel, and so have element and family") {
  CHECK(split_effect("chamber_leak_2").base == "chamber_leak");
  CHECK(split_effect("chamber_leak_2").side == "2");
  CHECK(split_effect("sensor_gain:p1_port").base == "sensor_gain");
  CHECK(split_effect("sensor_gain:p1_port").side == "p1_port");
  CHECK(split_effect("sensor_gain:p1_port").is_of_sensor);
  CHECK(split_effect("piston_leak").side.empty());
  CHECK(on_side_of("chamber", "chamber_leak_2") == "chamber_2");
  CHECK(on_side_of("sensor", "sensor_gain:x") == "sensor:x");
  CHECK(on_side_of("motion", "coulomb_friction") == "motion");
  CHECK(find_effect("something_new_1") == nullptr);
}

TEST_CASE("effects: each that is drawn changes the course of an axis") {
  const AxisParameters<double> nominal = test::nominal_axis();
  const std::vector<double> plain = course(nominal);
  CHECK(course(nominal) == plain);
  int drawn = 0;
  for (const EffectEntry* entry : all_effects())
    for (const EffectSignature& signature : entry->signatures) {
      if (entry->element == "sensor") continue;
      const std::string name =
          std::string(entry->name) + (signature.side.empty() ? "" : "_" + std::string(signature.side));
      INFO(name);
      AxisParameters<double> axis = nominal;
      set_effect(axis.effects, name, signature);
      CHECK(course(axis) != plain);
      ++drawn;
    }
  CHECK(drawn > 20);
}
