// Balances of gas and force under a supposed wiring.
#include "diagnosis/doubts/wiring_balance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <optional>
#include <vector>

#include <pneuservo/elements/valve.hpp>

#include "diagnosis/doubts/misfits.hpp"
#include "diagnosis/doubts/side_gas.hpp"
#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/residuals/force_balance.hpp"

namespace pneuservo {

namespace {

using Series = std::vector<double>;

double square_of_swing(const Series& values, const std::vector<std::size_t>& rows) {
  double sum = 0, squares = 0;
  for (const std::size_t k : rows) sum += values[k];
  const double mean = sum / static_cast<double>(rows.size());
  for (const std::size_t k : rows) squares += (values[k] - mean) * (values[k] - mean);
  return squares;
}

/// What is left of `wanted` beside a constant and `given` times a factor of at least 0, as a share of `swing`, at
/// most 1.
double left_share(const Series& wanted, const Series& given, const std::vector<std::size_t>& rows, double swing) {
  double sum_a = 0, sum_b = 0, aa = 0, ab = 0, bb = 0;
  for (const std::size_t k : rows) sum_a += given[k], sum_b += wanted[k];
  const auto count = static_cast<double>(rows.size());
  for (const std::size_t k : rows) {
    const double a = given[k] - sum_a / count, b = wanted[k] - sum_b / count;
    aa += a * a, ab += a * b, bb += b * b;
  }
  return std::min((bb - (aa > 0 && ab > 0 ? ab * ab / aa : 0.0)) / swing, 1.0);
}

class Balances {
 public:
  Balances(const Rig& rig, const CylinderRecording& prepared)
      : rig_(rig), axis_(rig.axis), prepared_(prepared), motion_(smoothed_motion(rig, prepared)) {
    for (Valve<double>& valve : valves_) valve.configure(axis_.valve, axis_.effects.valve, prepared.period_s());
    valves_[0].set_edges(PortEdges<double>::of_port_1(axis_.effects.valve));
    valves_[1].set_edges(PortEdges<double>::of_port_2(axis_.effects.valve));
    double top_mps = 0;
    for (std::size_t k = 0; k < motion_.samples(); ++k)
      if (motion_.usable()[k]) top_mps = std::max(top_mps, std::abs(motion_.velocity_mps()[k]));
    for (std::size_t k = 0; k < motion_.samples(); ++k) {
      if (!prepared.usable[k] || !motion_.usable()[k]) continue;
      rows_.push_back(k);
      if (std::abs(motion_.velocity_mps()[k]) > slow_share * top_mps) moving_.push_back(k);
    }
  }

  double misfit() const {
    if (moving_.size() <= 2 * motion_.kernel().reach()) return infinite_misfit;
    double sum = 0, count = 0;
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
      if (const auto left = gas(side)) sum += *left, ++count;
    for (const auto& pair : {port_signals, chamber_signals})
      if (const auto left = force(pair)) sum += *left, ++count;
    return count > 0 ? std::sqrt(sum / count) : infinite_misfit;
  }

 private:
  std::optional<double> gas(std::size_t side) const {
    const std::optional<SideGas> gas = side_gas(rig_, prepared_, side);
    if (!gas) return std::nullopt;
    Series flow_kgps;
    for (std::size_t k = 0; k < gas->port_Pa.size(); ++k) {
      const double command_V = prepared_.inputs.command_V[0][k];
      const PortAreas<double> areas = valves_[side].areas(side == 0 ? command_V : -command_V);
      const double flow = areas.supply * gas->filling[k] - areas.exhaust * gas->emptying[k];
      flow_kgps.push_back(std::isfinite(flow) ? flow : 0.0);
    }
    const Series wanted = motion_.kernel().apply(gas->mass_kg, 1);
    return left_share(wanted, motion_.kernel().apply(flow_kgps, 0), rows_, square_of_swing(wanted, rows_));
  }

  std::optional<double> force(const std::array<Signal, 2>& at) const {
    if (prepared_.measured[at[0]].empty() || prepared_.measured[at[1]].empty()) return std::nullopt;
    const Series p1_Pa = held_over_gaps(prepared_.measured[at[0]]), p2_Pa = held_over_gaps(prepared_.measured[at[1]]);
    Series left_N(p1_Pa.size()), direction(p1_Pa.size());
    for (std::size_t k = 0; k < left_N.size(); ++k)
      left_N[k] = axis_.cylinder.area_1_m2 * p1_Pa[k] - axis_.cylinder.area_2_m2 * p2_Pa[k];
    left_N = motion_.kernel().apply(left_N, 0);
    const double swing = square_of_swing(left_N, moving_);
    const Series acceleration = motion_.kernel().apply(motion_.velocity_mps(), 1);
    for (std::size_t k = 0; k < left_N.size(); ++k) {
      left_N[k] -= (axis_.slider.mass_kg + axis_.slider.payload_kg) * acceleration[k];
      direction[k] = motion_.velocity_mps()[k] > 0 ? 1.0 : -1.0;
    }
    return left_share(left_N, direction, moving_, swing);
  }

  const Rig& rig_;
  const AxisParameters<double>& axis_;
  const CylinderRecording& prepared_;
  ForceBalance motion_;
  std::array<Valve<double>, 2> valves_;  ///< of each port, with its own edges
  std::vector<std::size_t> rows_, moving_;
};

}  // namespace

double balance_misfit(const Rig& rig, const Recording& recording) {
  return misfit_or_infinite([&] { return Balances(rig, prepare_recording(recording, rig, judged_s)).misfit(); });
}

}  // namespace pneuservo
