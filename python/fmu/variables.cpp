// Value references of an FMU, and the sections of a config that concern it.
#include "variables.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "config/input_error.hpp"
#include "config/rig_parameters.hpp"

namespace pneuservo::fmu {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();
// Room for what later versions add, so that a reference keeps its meaning.
constexpr unsigned first_output = 100, first_parameter = 1000;

// Sections that say nothing to the model.
bool concerns(std::string_view path, Model model) {
  constexpr std::array of_the_loop{"controller.", "reference.", "duration_s",   "limits.",        "sensors.",
                                   "import.",     "hal.",       "safe_output.", "effects.sensor_"};
  constexpr std::array of_the_plant{"simulation.", "initial.", "slider."};
  constexpr std::array of_the_estimator{"estimator."};
  const auto begins = [&](std::string_view section) { return path.starts_with(section); };
  if (std::ranges::any_of(of_the_loop, begins)) return false;
  return model == Model::plant ? std::ranges::none_of(of_the_estimator, begins)
                               : std::ranges::none_of(of_the_plant, begins);
}

Variable quantity(Causality causality, std::string_view name, std::string_view unit, std::string_view help,
                  double start) {
  return {0, causality, std::string(name), std::string(unit), std::string(help), start, -none, none};
}

std::vector<Variable> inputs_of(const Rig& rig, Model model) {
  std::vector<Variable> out;
  const auto add = [&](std::string_view name, std::string_view unit, std::string_view help, double start) {
    out.push_back(quantity(Causality::input, name, unit, help, start));
  };
  if (model == Model::plant) {
    for (const std::string& name : command_columns(rig)) add(name, "V", "command of the valve", 0.0);
    return out;
  }
  const double pressure_Pa = rig.initial.pressure_1_Pa;
  for (const Signal signal : {Signal::p1_port, Signal::p2_port})
    add(info(signal).column, "Pa", "pressure at the valve's port, absolute", pressure_Pa);
  add(info(Signal::x).column, "m", "position, 0 at mid-stroke", rig.initial.position_m);
  add("v_mps", "m/s", "velocity", 0.0);
  for (const std::string& name : command_columns(rig)) add(name, "V", "command that was held", 0.0);
  return out;
}

std::vector<Variable> outputs_of(Model model) {
  std::vector<Variable> out;
  const auto add = [&](std::string_view name, std::string_view unit, std::string_view help) {
    out.push_back(quantity(Causality::output, name, unit, help, 0.0));
  };
  if (model == Model::plant) {
    for (const Signal signal : plant_signals)
      add(info(signal).column, info(signal).unit, "as an ideal sensor shows it");
    add("v_mps", "m/s", "velocity");
  } else {
    for (const EstimatedOutput& output : estimated_outputs) add(output.name, output.unit, output.help);
  }
  add("inner_step_s", "s", "sub-step of the lines in the last period, 0 before the first");
  add("health", "1", model == Model::plant ? "0: good, 1: the state is not finite" : "bits of the estimator, 0: good");
  return out;
}

}  // namespace

std::string_view name_of(Causality causality) {
  constexpr std::array<std::string_view, 4> names{"input", "output", "independent", "parameter"};
  return names[static_cast<std::size_t>(causality)];
}

std::string_view name_of(Model model) { return model == Model::plant ? "plant" : "estimator"; }

Model model_named(std::string_view name) {
  for (const Model model : {Model::plant, Model::estimator})
    if (name == name_of(model)) return model;
  throw InputError("FMU: model: found \"" + std::string(name) + "\", expected plant or estimator");
}

std::vector<Variable> variables_of(const Rig& rig, Model model) {
  if (!rig.is_pneumatic())
    throw InputError("rig: found " + std::string(info(rig.kind).name) +
                     ", expected cylinder or servo_table: only cylinders and servo tables have an FMU");
  std::vector<Variable> out = inputs_of(rig, model);
  for (unsigned i = 0; i < out.size(); ++i) out[i].reference = i;
  unsigned next = first_output;
  for (Variable& output : outputs_of(model)) {
    output.reference = next++;
    out.push_back(std::move(output));
  }
  out.push_back(quantity(Causality::independent, "time", "s", "simulation time", 0.0));
  out.back().reference = first_parameter - 1;
  next = first_parameter;
  for (const ParameterPath& p : parameter_paths(rig))
    if (concerns(p.path, model))
      out.push_back({next++, Causality::parameter, p.path, std::string(p.field.unit), std::string(p.field.help),
                     p.value, p.field.minimum, p.field.maximum});
  return out;
}

}  // namespace pneuservo::fmu
