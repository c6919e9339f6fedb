// The runs that `run` compares.
#include "program/run_variants.hpp"

#include <optional>

#include <fmt/format.h>

#include "program/loop_check.hpp"

namespace pneuservo {
namespace {

std::vector<std::optional<PressureSource>> sources_of(const std::string& word) {
  if (word != every_variant) return {std::nullopt};
  return {PressureSource::valve, PressureSource::chamber, PressureSource::estimated};
}

std::vector<std::optional<FeedforwardSource>> feedforwards_of(const std::string& word) {
  if (word != every_variant) return {std::nullopt};
  return {FeedforwardSource::off, FeedforwardSource::formula, FeedforwardSource::pass};
}

template <class Names, class Choice> void add_word(std::string& name, const Names& names, const Choice& choice) {
  if (choice) name += (name.empty() ? "" : "-") + std::string(names[static_cast<std::size_t>(*choice)]);
}

}  // namespace

std::vector<RunVariant> run_variants(const Rig& rig, const std::string& pressure_source,
                                     const std::string& feedforward) {
  std::vector<RunVariant> variants;
  for (const auto source : sources_of(pressure_source)) {
    for (const auto fed : feedforwards_of(feedforward)) {
      RunVariant variant{rig, "", fed.has_value()};
      add_word(variant.name, pressure_source_names, source);
      add_word(variant.name, feedforward_source_names, fed);
      if (source) variant.rig.controller.choose_pressures(*source);
      if (fed) {
        PdForceParameters& law = variant.rig.controller.of<PdForce>();
        law.flow_feedforward = *fed;
        law.without_pass = WithoutPass::formula;
      }
      variants.push_back(std::move(variant));
    }
  }
  return variants;
}

void heed_passes(const std::string& config, std::vector<RunVariant>& variants) {
  std::erase_if(variants, [&](RunVariant& variant) {
    const bool wants_pass = variant.rig.controller.wants_pass();
    heed_pass(variant.name.empty() ? config : fmt::format("{}, {}", config, variant.name), variant.rig);
    return variant.is_compared && wants_pass && !variant.rig.controller.wants_pass();
  });
}

}  // namespace pneuservo
