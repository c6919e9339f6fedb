// What commands that a slow logger did not keep may do to the gas.
#include "diagnosis/residuals/command_gaps.hpp"

#include <algorithm>
#include <cmath>

#include <pneuservo/core/random.hpp>

#include "diagnosis/recordings/held_out.hpp"
#include "diagnosis/recordings/noise_level.hpp"

namespace pneuservo {

namespace {

bool holds_every_command(const ImposedInputs& inputs) {
  return inputs.command_samples == 1 && (inputs.steps == 1 || inputs.command_is_held);
}

/// Gas under the first commands less that under the others; empty where it cannot be simulated.
GasCourse difference_of(const ImposedInputs& inputs, const ImposedInputs& others, const Rig& rig, const PlantGrid& grid,
                        const StopQuestion& stop) {
  const std::array<ImposedRun, 1> run{{{&rig, {}}}};
  GasCourse out = run_imposed(inputs, run, grid, stop)[0];
  const GasCourse other = run_imposed(others, run, grid, stop)[0];
  for (const Signal signal : gas_signals) {
    for (std::size_t k = 0; k < out[signal].size(); ++k) out[signal][k] -= other[signal][k];
    if (!out[signal].empty() && !std::isfinite(out[signal].back())) return {};
  }
  return out;
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
  return difference_of(inputs, sparse, rig, grid, stop);
}

GasCourse unseen_command_change(const ImposedInputs& inputs, const Rig& rig, const PlantGrid& grid,
                                const StopQuestion& stop) {
  if (holds_every_command(inputs)) return {};
  ImposedInputs drawn(inputs);
  Random random(1);
  const std::size_t steps_of_one = inputs.command_samples * static_cast<std::size_t>(inputs.steps);
  for (std::size_t valve = 0; valve < 2; ++valve) {
    const std::vector<double>& command = inputs.command_V[valve];
    std::vector<double> recorded;
    for (std::size_t k = inputs.first_command; k < command.size(); k += inputs.command_samples)
      recorded.push_back(command[k]);
    const double noise_V = usual_noise(recorded, inputs.period_s * static_cast<double>(inputs.command_samples));
    const std::size_t first = inputs.first_command * static_cast<std::size_t>(inputs.steps);
    std::vector<double>& quick = drawn.quick_command_V[valve];
    quick.resize(command.size() * static_cast<std::size_t>(inputs.steps));
    for (std::size_t i = 0; i < quick.size(); ++i)
      if ((i + steps_of_one - first % steps_of_one) % steps_of_one != 0) quick[i] = noise_V * random.normal();
  }
  return difference_of(drawn, inputs, rig, grid, stop);
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
