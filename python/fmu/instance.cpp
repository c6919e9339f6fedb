// An FMU at work: periods of the plant or of the estimator between two communication points.
#include "instance.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <pneuservo/loop/axis_loop.hpp>

#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "config/rig_parameters.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo::fmu {
namespace {

// A step may be the difference of two times; this share of a period is more than they round by in a year.
constexpr double most_rounding = 1e-3;
// A time belongs to the step that ends nearest to it.
constexpr double same_time = 0.25;

nlohmann::json about(const std::filesystem::path& resources) {
  const std::filesystem::path path = resources / "fmu.json";
  std::ifstream file(path);
  nlohmann::json out = nlohmann::json::parse(file, nullptr, false);
  if (out.is_discarded() || !out.contains("model") || !out.contains("token"))
    throw InputError(path.string() + ": cannot be read: the FMU is not whole; export it again");
  return out;
}

}  // namespace

Instance::Instance(const std::filesystem::path& resources, std::string_view token)
    : source_((resources / "config.yaml").string()) {
  const nlohmann::json made = about(resources);
  if (const auto own = made["token"].get<std::string>(); own != token)
    throw InputError(fmt::format("FMU: found the token \"{}\", expected \"{}\": model description and resources are of "
                                 "two exports; export it again",
                                 token, own));
  model_ = model_named(made["model"].get<std::string>());
  declared_ = rig_ = read_rig(source_, {}, ConfigUse::simulation);
  reset();
}

void Instance::reset() {
  rig_ = declared_;
  variables_ = variables_of(rig_, model_);
  inputs_ = static_cast<std::size_t>(
      std::ranges::count(variables_, Causality::input, [](const Variable& v) { return v.causality; }));
  time_ = static_cast<std::size_t>(
      std::ranges::find(variables_, Causality::independent, [](const Variable& v) { return v.causality; }) -
      variables_.begin());
  is_prepared_ = is_started_ = false;
}

const Variable& Instance::variable(unsigned reference) const {
  const auto found = std::ranges::lower_bound(variables_, reference, {}, &Variable::reference);
  if (found == variables_.end() || found->reference != reference)
    throw InputError(
        fmt::format("FMU: found the value reference {}, expected one of the model description", reference));
  return *found;
}

double Instance::value(unsigned reference) {
  const Variable& found = variable(reference);
  if (found.causality == Causality::output && !is_started_) prepare();
  return found.start;
}

void Instance::set(unsigned reference, double value) {
  const Variable& found = variable(reference);
  if (found.causality == Causality::output || found.causality == Causality::independent)
    throw InputError(fmt::format("FMU: {}: found a value for an {}, expected an input or a parameter", found.name,
                                 name_of(found.causality)));
  if (found.causality == Causality::parameter) {
    if (is_started_)
      throw InputError(fmt::format("FMU: {}: found a value after the initialisation, expected it before", found.name));
    set_parameter(rig_, found.name, value);
  }
  variables_[static_cast<std::size_t>(&found - variables_.data())].start = value;
  is_prepared_ = false;
}

void Instance::set_time(double time_s) { variables_[time_].start = time_s; }

void Instance::start() {
  prepare();
  is_started_ = true;
}

// The model at its start, and what it shows there with the parameters and inputs of now.
void Instance::prepare() {
  if (is_prepared_) return;
  const Rig rig = parse_rig(dump_rig(rig_), source_);  // relations between values
  if (model_ == Model::plant) {
    plant_.configure(rig.axis, rig.period_s, rig.simulation.cells_per_m, valve_arrangement(rig));
    plant_.reset(plant_start(rig));
    take_outputs(true_values(plant_), plant_.velocity());
    show(0.0, 0.0);
  } else {
    estimator_.configure(estimator_parameters(rig));
    PipelineEstimator first = estimator_;  // whose first tick only starts it, at the pressures of its inputs
    const EstimatorOutput e = estimate(first);
    take_outputs(e);
    show(0.0, static_cast<double>(e.health));
  }
  is_prepared_ = true;
}

// Between the inputs and the time.
std::span<Variable> Instance::outputs() { return std::span(variables_).subspan(inputs_, time_ - inputs_); }

void Instance::take_outputs(const PerSignal<double>& measured, double v_mps) {
  for (std::size_t i = 0; i < plant_signals.size(); ++i) outputs()[i].start = measured[plant_signals[i]];
  outputs()[plant_signals.size()].start = v_mps;
}

void Instance::step_plant() {
  const double u1_V = variables_[0].start;
  plant_.step(u1_V, inputs_ == 2 ? variables_[1].start : -u1_V);
  take_outputs(true_values(plant_), plant_.velocity());
}

EstimatorOutput Instance::estimate(PipelineEstimator& estimator) const {
  EstimatorInput in{variables_[0].start, variables_[1].start, variables_[2].start, variables_[3].start,
                    variables_[4].start};
  if (inputs_ == 6) in.valve_command_2_V = variables_[5].start;
  return estimator.step(in);
}

void Instance::take_outputs(const EstimatorOutput& e) {
  for (std::size_t i = 0; i < estimated_outputs.size(); ++i) outputs()[i].start = estimated_outputs[i].of(e);
}

void Instance::step_estimator() {
  const EstimatorOutput e = estimate(estimator_);
  take_outputs(e);
  show(estimator_.axis().side().step_s(), static_cast<double>(e.health));
}

// The last two outputs of every model.
void Instance::show(double inner_step_s, double health) {
  const std::span<Variable> last = outputs().last(2);
  last[0].start = inner_step_s;
  last[1].start = health;
}

bool Instance::step(double time_s, double step_s) {
  if (!is_started_) throw InputError("FMU: found a step before the end of the initialisation");
  // Against the foreign clock's own last time: what a sum of steps has rounded by since the start does not count.
  double& now_s = variables_[time_].start;
  const double periods = step_s / rig_.period_s, whole = std::round(periods);
  if (!(whole >= 1.0) || !(std::fabs(periods - whole) <= most_rounding) ||
      !(std::fabs(time_s - now_s) <= same_time * rig_.period_s))
    throw InputError(fmt::format("FMU: found a communication step from {} s over {} s, expected whole periods of {} s "
                                 "from {} s, where the last one ended",
                                 time_s, step_s, rig_.period_s, now_s));
  for (double k = 0.0; k < whole; ++k) model_ == Model::plant ? step_plant() : step_estimator();
  now_s = time_s + step_s;
  if (model_ == Model::estimator) return true;
  const bool is_finite = std::ranges::all_of(outputs(), [](const Variable& v) { return std::isfinite(v.start); });
  show(plant_.sides().step_s(), is_finite ? 0.0 : 1.0);
  return is_finite;
}

}  // namespace pneuservo::fmu
