// Valve, supply, lines and chambers of supposed rigs along one recording, lane by lane.
#include "diagnosis/residuals/imposed_run.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/residuals/imposed_simulation.hpp"

namespace pneuservo {

namespace {

constexpr double fastest_flow_mps = 100.0;  // above it the Courant margin is used up, beyond 170 the guards act
/// Sub-steps that sound and flow need with this many cells.
double needed_substeps(const Rig& rig, int cells, double step_s) {
  const AxisParameters<double>& axis = rig.axis;
  const double sound =
      std::sqrt(axis.air.heat_capacity_ratio * axis.air.gas_constant_J_per_kgK * 1.2 * axis.air.temperature_K);
  const auto stiffness = [&](const LineParameters<double>& line, double dead_volume_m3) {
    const double dx = line.length_m / cells;
    return std::sqrt(std::max(1.0, 0.5 * (1.0 + line.section_m2() * dx / (0.7 * dead_volume_m3)))) / dx;
  };
  const double per_m = std::max(stiffness(axis.line_1, axis.cylinder.dead_volume_1_m3),
                                stiffness(axis.line_2, axis.cylinder.dead_volume_2_m3));
  return (sound + fastest_flow_mps) * per_m * step_s / 0.9;
}

}  // namespace

double ImposedInputs::command_at(std::size_t side, std::size_t k, int step) const {
  const std::size_t valve = has_two_valves() ? side : 0;
  const std::vector<double>& command = command_V[valve];
  const std::vector<double>& quick = quick_command_V[valve];
  const double beside =
      quick.empty() ? 0.0 : quick[k * static_cast<std::size_t>(steps) + static_cast<std::size_t>(step)];
  if (command_is_held || k + 1 >= command.size()) return command[k] + beside;
  return command[k] + (command[k + 1] - command[k]) * step / steps + beside;
}

double ImposedInputs::position_at(std::size_t k, int step) const {
  const double s = (step + 1.0) / steps, s2 = s * s, s3 = s2 * s;  // the cubic of both ends' places and speeds
  return position_m[k] + (3 * s2 - 2 * s3) * (position_m[k + 1] - position_m[k]) +
         period_s * ((s - 2 * s2 + s3) * velocity_mps[k] + (s3 - s2) * velocity_mps[k + 1]);
}

double ImposedInputs::supply_at(std::size_t k, int step) const {
  return supply_Pa[k] + supply_Pa_per_s[k] * period_s * (step + 0.5) / steps;
}

std::vector<GasCourse> run_imposed(const ImposedInputs& inputs, std::span<const ImposedRun> runs, const PlantGrid& grid,
                                   const StopQuestion& stop) {
  if (runs.size() == 1) return imposed::ImposedSimulation<double>(inputs, runs, grid, stop).run();
  return imposed::ImposedSimulation<Pack<double, imposed_lanes>>(inputs, runs, grid, stop).run();
}

PlantGrid grid_for(const Rig& rig, double work, double step_s) {
  PlantGrid best{8, std::max(1, static_cast<int>(std::ceil(needed_substeps(rig, 8, step_s))))};
  for (int cells = 9; cells <= 2000; ++cells) {
    const int substeps = std::max(1, static_cast<int>(std::ceil(needed_substeps(rig, cells, step_s))));
    if (cells * substeps > work) break;
    best = {cells, substeps};
  }
  return best;
}

}  // namespace pneuservo
