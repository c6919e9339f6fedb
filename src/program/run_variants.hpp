// The runs that `run` compares: one config with several pressure sources and feedforwards.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// One run of those that are compared.
struct RunVariant {
  Rig rig;
  std::string name;  ///< "valve", "off", "valve-off"; empty where there is one run alone
  bool is_compared = false;  ///< with the other feedforwards
};

/// The word that stands for each of the words of an option.
inline constexpr const char* every_variant = "all";

/// The config's own source and feedforward, or every one where the option says `all`; other words are in the rig.
std::vector<RunVariant> run_variants(const Rig& rig, const std::string& pressure_source,
                                     const std::string& feedforward);

/// Where no command pass can be made says so and goes on with the formula, if the config wants that; throws InputError
/// where it does not. A variant that is compared with the formula is left out instead.
void heed_passes(const std::string& config, std::vector<RunVariant>& variants);

}  // namespace pneuservo
