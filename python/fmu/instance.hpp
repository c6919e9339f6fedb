// One FMU at work: a plant or an estimator that a foreign program steps by value references.
#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <pneuservo/estimator/pipeline_estimator.hpp>
#include <pneuservo/rig/plant.hpp>

#include "variables.hpp"

namespace pneuservo::fmu {

/// Copies are states of their own. Every function throws InputError or std::runtime_error with one sentence.
class Instance {
 public:
  /// Reads fmu.json and config.yaml of the FMU's resources. `token` is that of the model description.
  Instance(const std::filesystem::path& resources, std::string_view token);

  /// Before start(), an output is that of the start with the parameters and inputs of now.
  double value(unsigned reference);
  /// Parameters are taken until start().
  void set(unsigned reference, double value);
  /// Before start(): when the first step begins.
  void set_time(double time_s);
  /// Ends the initialisation; checks the config with its new values as a file is checked.
  void start();
  /// Back to the config's own values, before the initialisation.
  void reset();
  /// From time_s, where the last step ended, over step_s, a whole number of the config's periods, with the inputs held.
  /// False: the state is not finite.
  bool step(double time_s, double step_s);

 private:
  const Variable& variable(unsigned reference) const;
  std::span<Variable> outputs();
  void prepare();
  void take_outputs(const PerSignal<double>& measured, double v_mps);
  void take_outputs(const EstimatorOutput& estimated);
  EstimatorOutput estimate(PipelineEstimator& estimator) const;
  void step_plant();
  void step_estimator();
  void show(double inner_step_s, double health);

  std::string source_;
  Model model_ = Model::plant;
  Rig declared_, rig_;
  std::vector<Variable> variables_;  // with the values of now in `start`
  std::size_t inputs_ = 0, time_ = 0;
  AxisPlant<double> plant_;
  PipelineEstimator estimator_;
  bool is_prepared_ = false, is_started_ = false;
};

}  // namespace pneuservo::fmu
