// What commands that no row holds do to the residuals of a pneumatic cylinder.
#include <algorithm>

#include "diagnosis/residuals/command_gaps.hpp"
#include "diagnosis/residuals/cylinder_residuals.hpp"

namespace pneuservo {

namespace {

/// Draws of the commands that no row holds: their mean square has a relative standard deviation of sqrt(2/4).
constexpr std::size_t command_draws = 4;

}  // namespace

std::vector<std::vector<double>> CylinderResiduals::gap_errors(std::size_t recording) const {
  const CylinderRecording& data = recordings_[recording];
  const RecordedRigs rigs(owner_, recordings_);
  const PlantGrid grid = grid_for(rigs[recording], ringing_effort, data.inputs.step_s());
  const GasCourse gas = command_gap_error(data.inputs, rigs[recording], grid, stop_);
  std::vector<std::vector<double>> out(channels_.size());
  if (gas[Signal::p1_port].empty()) return out;
  // A measured chamber stands for itself; a simulated one errs by what its port does not correct.
  std::vector<double> force(data.samples(), 0.0);
  for (std::size_t side = 0; side < 2; ++side) {
    if (!data.measured[chamber_signals[side]].empty()) continue;
    const double area = side == 0 ? owner_.axis.cylinder.area_1_m2 : -owner_.axis.cylinder.area_2_m2;
    const bool corrected = !data.measured[port_signals[side]].empty();
    const std::vector<double> chamber = balances_[recording].kernel().apply(gas[chamber_signals[side]], 0),
                              port = slow_kernels_[recording].apply(gas[port_signals[side]], 0);
    for (std::size_t k = 0; k < force.size(); ++k) force[k] += area * (chamber[k] - (corrected ? port[k] : 0.0));
  }
  for (std::size_t c = 0; c < channels_.size(); ++c)
    out[c] = size_around(signals_[c] == Signal::F ? force : gas[signals_[c]], data.period_s());
  return out;
}

Eigen::MatrixXd CylinderResiduals::unseen_commands(const Hypothesis& hypothesis) {
  const RecordedRigs rigs = gas_->rigs_of(hypothesis);
  std::vector<std::vector<GasCourse>> changes(recordings_.size());
  in_parallel(recordings_.size(), jobs_, [&](std::size_t r) {
    const ImposedInputs& inputs = recordings_[r].inputs;
    const PlantGrid grid = grid_for(rigs[r], ringing_effort, inputs.step_s());
    changes[r] = unseen_command_changes(inputs, rigs[r], grid, command_draws, stop_);
  });
  if (std::ranges::all_of(changes, [](const auto& draws) { return draws.empty(); })) return {};
  const std::vector<SidedCourse> gas = gas_->of(std::span(&hypothesis, 1)).front();
  const Eigen::VectorXd known = plain_column(hypothesis.rig, gas);
  Eigen::MatrixXd out(known.size(), static_cast<Eigen::Index>(command_draws));
  for (std::size_t draw = 0; draw < command_draws; ++draw) {
    std::vector<SidedCourse> drawn = gas;
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      if (changes[r].empty()) continue;
      GasCourse other;
      for (const Signal signal : gas_signals) {
        other[signal] = gas[r][signal];
        for (std::size_t k = 0; k < other[signal].size(); ++k) other[signal][k] += changes[r][draw][signal][k];
      }
      drawn[r] = SidedCourse(std::move(other));
    }
    const auto column = static_cast<Eigen::Index>(draw);
    out.col(column) = plain_column(hypothesis.rig, drawn) - known;
  }
  return out.allFinite() ? out : Eigen::MatrixXd();
}

}  // namespace pneuservo
