// Free functions of time at the elements of a pneumatic cylinder, and what they do to its residuals.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "diagnosis/recordings/held_out.hpp"
#include "diagnosis/residuals/cylinder_residuals.hpp"

namespace pneuservo {

namespace {

/// Pieces of 100 ms are too long for a dead band of a loop that hunts: it passed for a flow past the piston.
constexpr double piece_s = 0.05;
/// Cells times sub-steps a second and line: answers to pieces of that length need no waves. Of 60 upper levels on five
/// clean machines 80 % are those of two and a half times the effort within 0.1 %, all of them within 8 %.
constexpr double bump_effort_per_s = 12e3;
/// Of the force's floor: small enough for a derivative at rest, where friction balances it.
constexpr double probed_share = 0.1;

/// Columns smoothed along their rows by the kernel that the force has been smoothed by.
Eigen::MatrixXd smoothed(const Eigen::MatrixXd& bins, const GaussianKernel& kernel, std::size_t bin) {
  std::vector<double> weights;  // of a bin so far away
  for (std::size_t distance = 0; distance * bin <= kernel.reach() + bin; ++distance) {
    double sum = 0;
    for (std::size_t a = 0; a < bin; ++a)
      for (std::size_t b = 0; b < bin; ++b) {
        const std::size_t to = distance * bin + b;
        sum += kernel.weight(to > a ? to - a : a - to);
      }
    weights.push_back(sum / static_cast<double>(bin));
  }
  const Eigen::Index rows = bins.rows();
  Eigen::MatrixXd out = weights[0] * bins;
  for (Eigen::Index d = 1; d < std::min(rows, static_cast<Eigen::Index>(weights.size())); ++d) {
    const double weight = weights[static_cast<std::size_t>(d)];
    out.topRows(rows - d) += weight * bins.bottomRows(rows - d);
    out.bottomRows(rows - d) += weight * bins.topRows(rows - d);
  }
  return out;
}

}  // namespace

std::pair<std::size_t, std::size_t> CylinderResiduals::rows_of(std::size_t recording) const {
  const auto is_here = [&](const ResidualRow& row) { return row.recording == static_cast<int>(recording); };
  const auto first = std::find_if(rows_.begin(), rows_.end(), is_here);
  const auto last = std::find_if_not(first, rows_.end(), is_here);
  return {static_cast<std::size_t>(first - rows_.begin()), static_cast<std::size_t>(last - rows_.begin())};
}

Eigen::VectorXd CylinderResiduals::answer_to_force(const Hypothesis& hypothesis) {
  const double probe_N = probed_share * std::hypot(channels_.back().floor, channels_.back().noise);
  std::vector<Hypothesis> probed{hypothesis, hypothesis};
  probed[1].rig.axis.effects.motion.constant_force.force_N += probe_N;
  const std::vector<Column> columns = plain_columns(probed);
  // A force with the motion is what a constant force takes off it.
  return (*columns[0] - *columns[1]) / probe_N;
}

Eigen::VectorXd CylinderResiduals::answer_to_readings() const {
  Eigen::VectorXd out(static_cast<Eigen::Index>(rows_.size()));
  for (std::size_t i = 0; i < rows_.size(); ++i) out(static_cast<Eigen::Index>(i)) = 1 / rows_[i].sigma;
  return out;
}

Eigen::MatrixXd CylinderResiduals::answer_of_rows(const BumpResponse& gas, std::array<double, 2> sides,
                                                  std::size_t recording, const Eigen::VectorXd& force_answer) const {
  const auto [first, last] = rows_of(recording);
  const CylinderRecording& data = recordings_[recording];
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(last - first), gas[Signal::p1_port].cols());
  for (const Stretch& stretch : stretches_) {
    if (stretch.recording != recording || stretch.bins.empty()) continue;
    const Signal signal = signals_[stretch.channel];
    const std::size_t bin = stretch.bins.front().count;
    Eigen::MatrixXd force;
    if (signal == Signal::F) {
      force = Eigen::MatrixXd::Zero(gas[Signal::p1_port].rows(), out.cols());
      const double areas[2]{owner_.axis.cylinder.area_1_m2, -owner_.axis.cylinder.area_2_m2};
      for (std::size_t side = 0; side < 2; ++side) {  // as chamber_pressure() has it
        if (!data.measured[chamber_signals[side]].empty()) continue;
        const double factor = sides[side] * areas[side];
        force += factor * smoothed(gas[chamber_signals[side]], balances_[recording].kernel(), bin);
        if (!data.measured[port_signals[side]].empty())
          force -= factor * smoothed(gas[port_signals[side]], slow_kernels_[recording], bin);
      }
    }
    const double factor = signal == Signal::p_supply ? 0.5 * (sides[0] + sides[1]) : sides[side_of(signal)];
    const auto flow = [&](Eigen::Index at) {
      return sides[0] * gas.supply_flow_of_side[0].row(at) + sides[1] * gas.supply_flow_of_side[1].row(at);
    };
    for (std::size_t b = 0; b < stretch.bins.size(); ++b) {
      const std::size_t row = stretch.first_row + b;
      const auto at = static_cast<Eigen::Index>(stretch.bins[b].first / bin),
                 to = static_cast<Eigen::Index>(row - first);
      if (signal == Signal::F) out.row(to) = force_answer(static_cast<Eigen::Index>(row)) * force.row(at);
      else if (signal == Signal::supply_flow) out.row(to) = flow(at) / rows_[row].sigma;
      else out.row(to) = factor / rows_[row].sigma * gas[signal].row(at);
    }
  }
  return out;
}

LatentInput::Piece CylinderResiduals::latent_piece(const BumpTimes& bumps, std::size_t recording) const {
  LatentInput::Piece piece{static_cast<int>(recording), {}, rows_of(recording).first, {}};
  for (std::size_t b = 0; b < bumps.count; ++b)
    piece.time_s.push_back(recordings_[recording].time_s(bumps.begin(b)) +
                           0.5 * recordings_[recording].period_s() * static_cast<double>(bumps.length));
  return piece;
}

Eigen::MatrixXd CylinderResiduals::at_once(std::size_t channel, const Eigen::VectorXd& answers, const BumpTimes& bumps,
                                           std::size_t recording) const {
  const auto [first, last] = rows_of(recording);
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(last - first), static_cast<Eigen::Index>(bumps.count));
  for (const Stretch& stretch : stretches_) {
    if (stretch.recording != recording || stretch.channel != channel) continue;
    for (std::size_t b = 0; b < stretch.bins.size(); ++b) {
      const std::size_t row = stretch.first_row + b, sample = stretch.bins[b].first + stretch.bins[b].count / 2;
      if (sample < bumps.first) continue;
      const std::size_t bump = std::min((sample - bumps.first) / bumps.length, bumps.count - 1);
      out(static_cast<Eigen::Index>(row - first), static_cast<Eigen::Index>(bump)) =
          answers(static_cast<Eigen::Index>(row));
    }
  }
  return out;
}

void CylinderResiduals::add_sensor_latents(const Eigen::VectorXd& force_answer,
                                           std::span<const Eigen::MatrixXd> supply_answers,
                                           std::vector<LatentInput>& out) const {
  const Eigen::VectorXd reading = answer_to_readings();
  for (std::size_t c = 0; c + 1 < channels_.size(); ++c) {
    LatentInput input{
        fmt::format("sensor:{}", channels_[c].name), "error of this sensor alone", channels_[c].unit, {}, {}};
    const std::size_t side = side_of(signals_[c]);
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      const CylinderRecording& data = recordings_[r];
      if (data.measured[signals_[c]].empty()) continue;
      const bool is_imposed = signals_[c] == Signal::p_supply && !data.inputs.supply_Pa.empty();
      const BumpTimes bumps = bumps_of(data.inputs, piece_s);
      LatentInput::Piece piece = latent_piece(bumps, r);
      piece.answer = at_once(c, reading, bumps, r);
      // The force rests on the sensor at the chamber, or on the port's where the chamber has none. A model that knows
      // of its error takes it out of the drive.
      const bool is_used = signals_[c] == chamber_signals[side] ||
                           (is_port(signals_[c]) && data.measured[chamber_signals[side]].empty());
      const double area = side == 0 ? owner_.axis.cylinder.area_1_m2 : -owner_.axis.cylinder.area_2_m2;
      if (is_used) piece.answer += at_once(channels_.size() - 1, -area * force_answer, bumps, r);
      if (is_imposed) piece.answer -= supply_answers[r];  // the valves find what the sensor says less its error
      if (piece.answer.allFinite()) input.pieces.push_back(std::move(piece));
    }
    out.push_back(std::move(input));
  }
}

std::vector<LatentInput> CylinderResiduals::latent_inputs(const Hypothesis& hypothesis) {
  struct Place {
    const char *element, *what, *unit;
    GasInput input;
    std::array<double, 2> sides;
  };
  const double per_V = owner_.axis.valve.area_per_volt_m2_per_V;
  const std::array places{
      Place{"valve", "shift of the spool", "V", GasInput::valve_area, {per_V, -per_V}},
      Place{"valve", "shift of the spool as side 1 sees it", "V", GasInput::valve_area, {per_V, 0}},
      Place{"valve", "shift of the spool as side 2 sees it", "V", GasInput::valve_area, {0, per_V}},
      Place{"timing", "lateness of the command", "s", GasInput::command_time, {1, 1}},
      Place{"supply", "supply pressure", "Pa", GasInput::supply_pressure, {1, 1}},
      Place{"line_1", "flow into the line at its middle", "kg/s", GasInput::line_flow, {1, 0}},
      Place{"line_2", "flow into the line at its middle", "kg/s", GasInput::line_flow, {0, 1}},
      Place{"line_1", "pressure lost from the line to the chamber", "Pa", GasInput::end_loss, {1, 0}},
      Place{"line_2", "pressure lost from the line to the chamber", "Pa", GasInput::end_loss, {0, 1}},
      Place{"chamber_1", "flow into the chamber", "kg/s", GasInput::chamber_flow, {1, 0}},
      Place{"chamber_2", "flow into the chamber", "kg/s", GasInput::chamber_flow, {0, 1}},
      Place{"piston", "flow past the piston from chamber 2 to 1", "kg/s", GasInput::chamber_flow, {1, -1}},
  };
  std::vector<LatentInput> out;
  out.push_back({"motion", "force on the slider with the motion", "N", {}, answer_to_force(hypothesis)});
  const Eigen::VectorXd force_answer = out.front().own_answer;
  for (const Place& place : places) out.push_back({place.element, place.what, place.unit, {}, {}});
  const RecordedRigs rigs = gas_->rigs_of(hypothesis);
  std::vector<Eigen::MatrixXd> supply_answers(recordings_.size());
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    const CylinderRecording& data = recordings_[r];
    const auto bin = static_cast<std::size_t>(std::max(1.0, std::round(residual_bin_s / data.period_s())));
    const BumpTimes bumps = bumps_of(data.inputs, piece_s);
    const PlantGrid grid = grid_for(rigs[r], bump_effort_per_s * data.inputs.step_s(), data.inputs.step_s());
    const auto gas = bump_responses(data.inputs, GasRuns::run_of(rigs, hypothesis, r), grid, bumps, bin, jobs_, stop_);
    for (std::size_t i = 0; i < places.size(); ++i) {
      LatentInput::Piece piece = latent_piece(bumps, r);
      piece.answer = answer_of_rows(gas[static_cast<std::size_t>(places[i].input)], places[i].sides, r, force_answer);
      if (places[i].input == GasInput::supply_pressure && !data.inputs.supply_Pa.empty()) {
        supply_answers[r] = piece.answer;
        const auto channel = std::ranges::find(signals_, Signal::p_supply) - signals_.begin();
        piece.answer = at_once(static_cast<std::size_t>(channel), answer_to_readings(), bumps, r);
      }
      if (piece.answer.allFinite()) out[i + 1].pieces.push_back(std::move(piece));
    }
  }
  add_sensor_latents(force_answer, supply_answers, out);
  return out;
}

}  // namespace pneuservo
