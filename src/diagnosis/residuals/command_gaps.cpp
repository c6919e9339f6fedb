// What commands that a slow logger did not keep may do to the gas.
#include "diagnosis/residuals/command_gaps.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/recordings/held_out.hpp"

namespace pneuservo {

GasCourse command_gap_error(const ImposedInputs& inputs, const Rig& rig, const PlantGrid& grid,
                            const StopQuestion& stop) {
  const std::size_t samples = inputs.command_samples;
  if (samples == 1 && (inputs.steps == 1 || inputs.command_is_held)) return {};
  ImposedInputs sparse(inputs);
  for (std::vector<double>& command : sparse.command_V)
    for (std::size_t k = inputs.first_command; k + 2 * samples < command.size(); k += 2 * samples)
      for (std::size_t i = 1; i < 2 * samples; ++i)
        command[k + i] =
            std::lerp(command[k], command[k + 2 * samples], static_cast<double>(i) / static_cast<double>(2 * samples));
  const std::array<ImposedRun, 1> run{{{&rig, {}}}};
  GasCourse error = run_imposed(inputs, run, grid, stop)[0];
  const GasCourse other = run_imposed(sparse, run, grid, stop)[0];
  for (const Signal signal : gas_signals) {
    for (std::size_t k = 0; k < error[signal].size(); ++k) error[signal][k] -= other[signal][k];
    if (!error[signal].empty() && !std::isfinite(error[signal].back())) return {};
  }
  return error;
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
