// What an FMU of an axis shows of itself: inputs, outputs and parameters with their value references.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/estimator/pipeline_estimator.hpp>
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

/// First outputs of the plant; v_mps follows.
inline constexpr std::array plant_signals{Signal::x,          Signal::p1_port,  Signal::p2_port,    Signal::p1_chamber,
                                          Signal::p2_chamber, Signal::p_supply, Signal::supply_flow};

/// First outputs of the estimator.
struct EstimatedOutput {
  std::string_view name, unit, help;
  double (*of)(const EstimatorOutput&);
};
inline constexpr std::array estimated_outputs{
    EstimatedOutput{"p1_estimated_Pa", "Pa", "pressure of chamber 1, absolute",
                    [](const EstimatorOutput& e) { return e.chamber_pressure_Pa[0]; }},
    EstimatedOutput{"p2_estimated_Pa", "Pa", "pressure of chamber 2, absolute",
                    [](const EstimatorOutput& e) { return e.chamber_pressure_Pa[1]; }},
    EstimatedOutput{"p1_bound_Pa", "Pa", "what the estimate of chamber 1 may be wrong by",
                    [](const EstimatorOutput& e) { return e.error_bound_Pa[0]; }},
    EstimatedOutput{"p2_bound_Pa", "Pa", "what the estimate of chamber 2 may be wrong by",
                    [](const EstimatorOutput& e) { return e.error_bound_Pa[1]; }},
    EstimatedOutput{"mass_flow_1_kgps", "kg/s", "out of line 1 into chamber 1",
                    [](const EstimatorOutput& e) { return e.mass_flow_kgps[0]; }},
    EstimatedOutput{"mass_flow_2_kgps", "kg/s", "out of line 2 into chamber 2",
                    [](const EstimatorOutput& e) { return e.mass_flow_kgps[1]; }},
};

/// All variables of a model in the order of their references. Outputs have no start. The last two are
/// inner_step_s and health. Throws InputError for a rig that is not pneumatic.
std::vector<Variable> variables_of(const Rig& rig, Model model);

}  // namespace pneuservo::fmu
