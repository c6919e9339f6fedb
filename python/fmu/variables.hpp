// What an FMU of an axis shows of itself: inputs, outputs and parameters with their value references.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo::fmu {

enum class Model { plant, estimator };

/// Name of a model in resources and descriptions; throws InputError for another one.
std::string_view name_of(Model model);
Model model_named(std::string_view name);

enum class Causality { input, output, independent, parameter };

/// As model descriptions spell it.
std::string_view name_of(Causality causality);

/// One variable. A parameter's name is its config path.
struct Variable {
  unsigned reference;
  Causality causality;
  std::string name, unit, help;
  double start;
  double minimum, maximum;  ///< infinite: none
};

/// All variables of a model in the order of their references. Outputs have no start. Throws InputError for a rig that
/// is not pneumatic.
std::vector<Variable> variables_of(const Rig& rig, Model model);

}  // namespace pneuservo::fmu
