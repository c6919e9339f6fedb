// What short changes of what acts on the gas do to its pressures, to the end of a recording: derivatives in lanes.
#pragma once
#include <array>
#include <vector>

#include <Eigen/Core>

#include "diagnosis/residuals/imposed_run.hpp"

namespace pneuservo {

/// What a bump changes, of both sides at once where sides have their own: they hardly see each other. A supply that is
/// measured is another at the valves than its sensor says, and the model of it stays.
enum class GasInput { valve_area, line_flow, chamber_flow, end_loss, supply_pressure, command_time };
inline constexpr std::array gas_inputs{GasInput::valve_area, GasInput::line_flow,       GasInput::chamber_flow,
                                       GasInput::end_loss,   GasInput::supply_pressure, GasInput::command_time};
/// Size of a bump for a derivative: small beside what acts, large beside rounding [m2, kg/s, kg/s, Pa, Pa, s].
inline constexpr std::array<double, gas_inputs.size()> bump_sizes{1e-8, 1e-6, 1e-6, 100.0, 500.0, 1e-4};

/// Bumps one after the other from the gas's release on, each `count` samples long.
struct BumpTimes {
  std::size_t first = 0, length = 0, count = 0;
  std::size_t begin(std::size_t bump) const { return first + bump * length; }
};
BumpTimes bumps_of(const ImposedInputs& inputs, double length_s);

/// Mean change of each pressure and flow in each bin for one unit of input: bins by bumps. Bins are `bin` samples long
/// from sample 0 on; what is left at the end has none. A rig that cannot be simulated gives what is not finite.
struct BumpResponse : PerSignal<Eigen::MatrixXd> {
  std::array<Eigen::MatrixXd, 2> supply_flow_of_side;  ///< of the flow by each side, in place of their sum
};
/// In the order of gas_inputs.
std::array<BumpResponse, gas_inputs.size()> bump_responses(const ImposedInputs& inputs, const ImposedRun& run,
                                                           const PlantGrid& grid, const BumpTimes& bumps,
                                                           std::size_t bin, int jobs, const StopQuestion& stop = {});

}  // namespace pneuservo
