// Derivatives of pressures by short changes of what acts on the gas.
#include "diagnosis/residuals/gas_bumps.hpp"

#include <algorithm>
#include <memory>

#include "diagnosis/residuals/gas_runs.hpp"
#include "diagnosis/residuals/imposed_simulation.hpp"

namespace pneuservo {

namespace {

using Lanes = Pack<double, imposed_lanes>;
using Simulation = imposed::ImposedSimulation<Lanes>;
using Sides = Pair<Lanes>;

/// The undisturbed course: the plant as each group of bumps finds it, and its pressures at every sample.
struct Undisturbed {
  std::vector<AxisPlant<Lanes>> at_group;
  GasCourse course;
  std::array<std::vector<double>, 2> supply_flow_of_side;
};

/// What each side takes from the supply.
std::array<Lanes, 2> flow_of_sides(const AxisPlant<Lanes>& plant) {
  const Sides flow = plant.supply_flow();
  return {low(flow), high(flow)};
}

class BumpRuns {
 public:
  BumpRuns(const ImposedInputs& inputs, const ImposedRun& run, const PlantGrid& grid, const BumpTimes& bumps,
           std::size_t bin, const StopQuestion& stop)
      : inputs_(inputs), run_(run), grid_(grid), bumps_(bumps), bin_(bin), bins_(inputs.samples() / bin), stop_(stop) {
    runs_.fill(run_);
    const auto rows = static_cast<Eigen::Index>(bins_), columns = static_cast<Eigen::Index>(bumps.count);
    for (BumpResponse& response : responses_) {
      for (const Signal signal : pascal_signals) response[signal].setZero(rows, columns);
      for (Eigen::MatrixXd& flow : response.supply_flow_of_side) flow.setZero(rows, columns);
    }
  }
  std::size_t groups() const { return (bumps_.count + imposed_lanes - 1) / imposed_lanes; }

  void run_undisturbed() {
    Simulation simulation(inputs_, runs_, grid_, stop_);
    for (const Signal signal : pascal_signals) undisturbed_.course[signal].resize(inputs_.samples());
    for (std::vector<double>& flow : undisturbed_.supply_flow_of_side) flow.resize(inputs_.samples());
    simulation.begin();
    std::size_t group = 0;
    for (std::size_t k = 0;; ++k) {
      if (group < groups() && k == bumps_.begin(group * imposed_lanes)) {
        undisturbed_.at_group.push_back(simulation.plant());
        ++group;
      }
      const PerSignal<Lanes> values = true_values(simulation.plant());
      for (const Signal signal : pascal_signals) undisturbed_.course[signal][k] = lane(values[signal], 0);
      const std::array flows = flow_of_sides(simulation.plant());
      for (std::size_t side = 0; side < 2; ++side) undisturbed_.supply_flow_of_side[side][k] = lane(flows[side], 0);
      if (k + 1 >= inputs_.samples()) return;
      simulation.advance(k, Sides(0));
      if (k % steps_between_looks == 0) look_for_stop(stop_);
    }
  }

  void run_group(std::size_t input, std::size_t group) {
    Simulation simulation(inputs_, runs_, grid_, stop_);
    simulation.plant() = undisturbed_.at_group[group];
    const std::size_t first_bump = group * imposed_lanes, start = bumps_.begin(first_bump);
    const std::size_t lanes = std::min(imposed_lanes, bumps_.count - first_bump);
    const std::size_t all_over = bumps_.begin(first_bump + lanes);
    for (std::size_t k = start; k + 1 < inputs_.samples(); ++k) {
      Sides command(0);
      if (k <= all_over) command = impose(simulation, gas_inputs[input], first_bump, lanes, k);
      simulation.advance(k, command);
      if ((k + 1) / bin_ < bins_) store(simulation.plant(), input, first_bump, lanes, k + 1);
      if (k % steps_between_looks == 0) look_for_stop(stop_);
    }
  }
  std::array<BumpResponse, gas_inputs.size()> take() { return std::move(responses_); }

 private:
  /// Sets what acts from sample k on; returns what comes to the commands.
  Sides impose(Simulation& simulation, GasInput input, std::size_t first_bump, std::size_t lanes, std::size_t k) const {
    Lanes size(0);
    for (std::size_t i = 0; i < lanes; ++i) {
      const std::size_t begin = bumps_.begin(first_bump + i);
      if (k >= begin && k < begin + bumps_.length)
        set_lane(size, static_cast<int>(i), bump_sizes[static_cast<std::size_t>(input)]);
    }
    const Sides both = join(size, size);
    GasDisturbance<Lanes> disturbance;
    switch (input) {
      case GasInput::valve_area: disturbance.valve_area_m2 = both; break;
      case GasInput::line_flow: disturbance.line_flow_kgps = both; break;
      case GasInput::chamber_flow: disturbance.chamber_flow_kgps = both; break;
      case GasInput::end_loss: disturbance.end_loss_Pa = both; break;
      case GasInput::supply_pressure:
        if (inputs_.supply_Pa.empty())
          simulation.plant().set_supply_pressure(Lanes(run_.rig->axis.supply.pressure_Pa) + size);
        else simulation.add_to_measured_supply(size);
        return Sides(0);
      case GasInput::command_time: {  // later: a part of the command before is still there
        const auto rate = [&](std::size_t side) {
          const std::vector<double>& u = inputs_.command_of(side);
          return k == 0 ? 0.0 : (u[k - 1] - u[k]) / inputs_.period_s;
        };
        return join(Lanes(rate(0)) * size, Lanes(rate(1)) * size);
      }
    }
    simulation.plant().set_disturbance(disturbance);
    return Sides(0);
  }
  /// Adds sample k to its bin.
  void store(const AxisPlant<Lanes>& plant, std::size_t input, std::size_t first_bump, std::size_t lanes,
             std::size_t k) {
    const PerSignal<Lanes> values = true_values(plant);
    const std::array flows = flow_of_sides(plant);
    const auto bin = static_cast<Eigen::Index>(k / bin_);
    const double weight = 1 / (bump_sizes[input] * static_cast<double>(bin_));
    const auto add = [&](Eigen::MatrixXd& to, const Lanes& value, double undisturbed) {
      for (std::size_t i = 0; i < lanes; ++i)
        to(bin, static_cast<Eigen::Index>(first_bump + i)) += weight * (lane(value, static_cast<int>(i)) - undisturbed);
    };
    BumpResponse& response = responses_[input];
    for (const Signal signal : pascal_signals) add(response[signal], values[signal], undisturbed_.course[signal][k]);
    for (std::size_t side = 0; side < 2; ++side)
      add(response.supply_flow_of_side[side], flows[side], undisturbed_.supply_flow_of_side[side][k]);
  }

  const ImposedInputs& inputs_;
  ImposedRun run_;
  std::array<ImposedRun, imposed_lanes> runs_;
  PlantGrid grid_;
  BumpTimes bumps_;
  std::size_t bin_, bins_;
  const StopQuestion& stop_;
  Undisturbed undisturbed_;
  std::array<BumpResponse, gas_inputs.size()> responses_;
};

}  // namespace

BumpTimes bumps_of(const ImposedInputs& inputs, double length_s) {
  const auto length = static_cast<std::size_t>(std::max(1.0, std::round(length_s / inputs.period_s)));
  const std::size_t first = std::max<std::size_t>(inputs.release, 1), samples = inputs.samples();
  return {first, length, samples > first + 1 ? (samples - 1 - first + length - 1) / length : 0};
}

std::array<BumpResponse, gas_inputs.size()> bump_responses(const ImposedInputs& inputs, const ImposedRun& run,
                                                           const PlantGrid& grid, const BumpTimes& bumps,
                                                           std::size_t bin, int jobs, const StopQuestion& stop) {
  BumpRuns runs(inputs, run, grid, bumps, bin, stop);
  runs.run_undisturbed();
  in_parallel(runs.groups() * gas_inputs.size(), jobs,
              [&](std::size_t i) { runs.run_group(i % gas_inputs.size(), i / gas_inputs.size()); });
  return runs.take();
}

}  // namespace pneuservo
