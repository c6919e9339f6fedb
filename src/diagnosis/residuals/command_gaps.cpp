// What commands that a slow logger did not keep may do to the gas.
#include "diagnosis/residuals/command_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <pneuservo/core/random.hpp>

#include "diagnosis/recordings/held_out.hpp"
#include "diagnosis/recordings/noise_level.hpp"

namespace pneuservo {

namespace {

bool holds_every_command(const ImposedInputs& inputs) {
  return inputs.command_samples == 1 && (inputs.steps == 1 || inputs.command_is_held);
}

GasCourse gas_under(const ImposedInputs& inputs, const Rig& rig, const PlantGrid& grid, const StopQuestion& stop) {
  const std::array<ImposedRun, 1> run{{{&rig, {}}}};
  return std::move(run_imposed(inputs, run, grid, stop)[0]);
}

/// Empty where one of them cannot be simulated.
GasCourse difference_of(GasCourse gas, const GasCourse& other) {
  for (const Signal signal : gas_signals) {
    for (std::size_t k = 0; k < gas[signal].size(); ++k) gas[signal][k] -= other[signal][k];
    if (!gas[signal].empty() && !std::isfinite(gas[signal].back())) return {};
  }
  return gas;
}

}  // namespace

GasCourse command_gap_error(const ImposedInputs& inputs, const Rig& rig, const PlantGrid& grid,
                            const StopQuestion& stop) {
  if (holds_every_command(inputs)) return {};
  const std::size_t samples = inputs.command_samples;
  ImposedInputs sparse(inputs);
  for (std::vector<double>& command : sparse.command_V)
    for (std::size_t k = inputs.first_command; k + 2 * samples < command.size(); k += 2 * samples)
      for (std::size_t i = 1; i < 2 * samples; ++i)
        command[k + i] =
            std::lerp(command[k], command[k + 2 * samples], static_cast<double>(i) / static_cast<double>(2 * samples));
  return difference_of(gas_under(inputs, rig, grid, stop), gas_under(sparse, rig, grid, stop));
}

std::vector<GasCourse> unseen_command_changes(const ImposedInputs& inputs, const Rig& rig, const PlantGrid& grid,
                                              std::size_t draws, const StopQuestion& stop) {
  if (holds_every_command(inputs)) return {};
  const GasCourse known = gas_under(inputs, rig, grid, stop);
  const std::size_t steps_of_one = inputs.command_samples * static_cast<std::size_t>(inputs.steps);
  const std::size_t first = inputs.first_command * static_cast<std::size_t>(inputs.steps);
  std::array<double, 2> noise_V{};
  for (std::size_t valve = 0; valve < 2; ++valve) {
    std::vector<double> recorded;
    for (std::size_t k = inputs.first_command; k < inputs.command_V[valve].size(); k += inputs.command_samples)
      recorded.push_back(inputs.command_V[valve][k]);
    noise_V[valve] = usual_noise(recorded, inputs.period_s * static_cast<double>(inputs.command_samples));
  }
  Random random(1);
  std::vector<GasCourse> out;
  for (std::size_t draw = 0; draw < draws; ++draw) {
    ImposedInputs drawn(inputs);
    for (std::size_t valve = 0; valve < 2; ++valve) {
      std::vector<double>& quick = drawn.quick_command_V[valve];
      quick.resize(inputs.command_V[valve].size() * static_cast<std::size_t>(inputs.steps));
      double slow = 0;
      for (std::size_t i = 0; i < quick.size(); ++i) {
        const std::size_t since = (i + steps_of_one - first % steps_of_one) % steps_of_one;
        if (since == 0) slow = std::numbers::sqrt2 * random.normal();
        else
          quick[i] = noise_V[valve] * (random.normal() + slow * std::sin(std::numbers::pi * static_cast<double>(since) /
                                                                         static_cast<double>(steps_of_one)));
      }
    }
    out.push_back(difference_of(gas_under(drawn, rig, grid, stop), known));
    if (out.back()[Signal::p1_port].empty()) return {};
  }
  return out;
}

std::vector<double> size_around(const std::vector<double>& error, double period_s) {
  const auto half = static_cast<std::size_t>(std::lround(0.5 * floor_correlation_s / period_s));
  std::vector<double> squares(error.size() + 1, 0.0), out(error.size());
  for (std::size_t k = 0; k < error.size(); ++k) squares[k + 1] = squares[k] + error[k] * error[k];
  for (std::size_t k = 0; k < error.size(); ++k) {
    const std::size_t first = k - std::min(k, half), end = std::min(error.size(), k + half + 1);
    out[k] = std::sqrt(std::max(0.0, squares[end] - squares[first]) / static_cast<double>(end - first));
  }
  return out;
}

}  // namespace pneuservo
