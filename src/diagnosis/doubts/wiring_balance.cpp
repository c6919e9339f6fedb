// Balances of gas and force under a supposed wiring.
#include "diagnosis/doubts/wiring_balance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <vector>

#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/valve.hpp>

#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/residuals/force_balance.hpp"

namespace pneuservo {

namespace {

using Series = std::vector<double>;

constexpr double least_periods = 2.5;  ///< as of every balance of forces
/// What the rate of noisy pressures asks for beside the delay: 5 to 80 ms gave the same answers on 120 recordings of 12
/// simulated machines, none missed a slow one.
constexpr double noise_s = 0.02;

/// From the valve's command to the gas in the chamber: the spool, and sound along the longer line.
double delay_s(const AxisParameters<double>& axis) {
  const double natural_Hz = axis.valve.natural_frequency_Hz;
  return (natural_Hz > 0 ? 1 / (2 * M_PI * natural_Hz) : 0.0) +
         std::max(axis.line_1.length_m, axis.line_2.length_m) / Air<double>(axis.air).sound_speed();
}

double square_of_swing(const Series& values, const std::vector<std::size_t>& rows) {
  double sum = 0, squares = 0;
  for (const std::size_t k : rows) sum += values[k];
  const double mean = sum / static_cast<double>(rows.size());
  for (const std::size_t k : rows) squares += (values[k] - mean) * (values[k] - mean);
  return squares;
}

enum class Factor { free, one };

/// What is left of `wanted` beside a constant and `given` times a factor of at least 0, as a share of `swing`, at
/// most 1.
double left_share(const Series& wanted, const Series& given, const std::vector<std::size_t>& rows, double swing,
                  Factor factor) {
  double sum_a = 0, sum_b = 0, aa = 0, ab = 0, bb = 0;
  for (const std::size_t k : rows) sum_a += given[k], sum_b += wanted[k];
  const auto count = static_cast<double>(rows.size());
  for (const std::size_t k : rows) {
    const double a = given[k] - sum_a / count, b = wanted[k] - sum_b / count;
    aa += a * a, ab += a * b, bb += b * b;
  }
  const double explained = factor == Factor::one ? 2 * ab - aa : aa > 0 && ab > 0 ? ab * ab / aa : 0.0;
  return std::min((bb - explained) / swing, 1.0);
}

class Balances {
 public:
  Balances(const Rig& rig, const CylinderRecording& prepared)
      : axis_(rig.axis), air_(rig.axis.air), prepared_(prepared),
        motion_(prepared.position_m, prepared.period_s(), rig.sensors.position.rms_m(),
                std::max(least_periods, (noise_s + delay_s(rig.axis)) / prepared.period_s())) {
    valve_.configure(axis_.valve, axis_.effects.valve, prepared.period_s());
    double top_mps = 0;
    for (std::size_t k = 0; k < motion_.samples(); ++k)
      if (motion_.usable()[k]) top_mps = std::max(top_mps, std::abs(motion_.velocity_mps()[k]));
    for (std::size_t k = 0; k < motion_.samples(); ++k) {
      if (!prepared.usable[k] || !motion_.usable()[k]) continue;
      rows_.push_back(k);
      if (std::abs(motion_.velocity_mps()[k]) > slow_share * top_mps) moving_.push_back(k);
    }
  }

  /// Of the gas alone where the valve's gain is as stated.
  double misfit(Factor gain) const {
    if (moving_.size() <= 2 * motion_.kernel().reach()) return std::numeric_limits<double>::infinity();
    double sum = 0, count = 0;
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
      if (const auto left = gas(side, gain)) sum += *left, ++count;
    for (const auto& pair : {port_signals, chamber_signals})
      if (const auto left = gain == Factor::free ? force(pair) : std::nullopt) sum += *left, ++count;
    return count > 0 ? std::sqrt(sum / count) : std::numeric_limits<double>::infinity();
  }

 private:
  /// Of a side's port, else of its chamber; empty where neither is measured.
  Series measured(std::size_t side, bool at_chamber) const {
    const Series &port = prepared_.measured[port_signals[side]], &chamber = prepared_.measured[chamber_signals[side]];
    const Series &wished = at_chamber ? chamber : port, &other = at_chamber ? port : chamber;
    return held_over_gaps(wished.empty() ? other : wished);
  }

  std::optional<double> gas(std::size_t side, Factor gain) const {
    const Series port_Pa = measured(side, false), chamber_Pa = measured(side, true);
    if (port_Pa.empty()) return std::nullopt;
    const auto& cylinder = axis_.cylinder;
    const auto& line = side == 0 ? axis_.line_1 : axis_.line_2;
    const double towards = side == 0 ? 1.0 : -1.0, area_m2 = side == 0 ? cylinder.area_1_m2 : cylinder.area_2_m2,
                 dead_m3 = side == 0 ? cylinder.dead_volume_1_m3 : cylinder.dead_volume_2_m3;
    Series mass_kg(port_Pa.size()), flow_kgps(port_Pa.size());
    for (std::size_t k = 0; k < port_Pa.size(); ++k) {
      const double way_m = 0.5 * cylinder.stroke_m + towards * motion_.position_m()[k];
      mass_kg[k] = (chamber_Pa[k] * (dead_m3 + area_m2 * std::max(way_m, 0.0)) +
                    0.5 * (port_Pa[k] + chamber_Pa[k]) * line.volume_m3()) /
                   (air_.R * air_.temperature_K);
      flow_kgps[k] = valve_flow(towards * prepared_.inputs.command_V[0][k], supply_at(k), port_Pa[k]);
    }
    const Series wanted = motion_.kernel().apply(mass_kg, 1);
    return left_share(wanted, motion_.kernel().apply(flow_kgps, 0), rows_, square_of_swing(wanted, rows_), gain);
  }

  double supply_at(std::size_t k) const {
    return prepared_.inputs.supply_Pa.empty() ? axis_.supply.pressure_Pa : prepared_.inputs.supply_Pa[k];
  }

  /// Into the side whose edges this command moves.
  double valve_flow(double command_V, double supply_Pa, double port_Pa) const {
    if (!(port_Pa > 0) || !std::isfinite(command_V)) return 0.0;
    const PortAreas<double> areas = valve_.areas(command_V);
    const double T = air_.temperature_K, ratio = axis_.valve.critical_pressure_ratio;
    return orifice_mass_flow(air_, areas.supply, ratio, supply_Pa, T, port_Pa, T) -
           orifice_mass_flow(air_, areas.exhaust, ratio, port_Pa, T, air_.atmosphere_Pa, T);
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
    return left_share(left_N, direction, moving_, swing, Factor::free);
  }

  const AxisParameters<double>& axis_;
  Air<double> air_;
  const CylinderRecording& prepared_;
  ForceBalance motion_;
  Valve<double> valve_;
  std::vector<std::size_t> rows_, moving_;
};

double misfit_of(const Rig& rig, const Recording& recording, double judged_s, Factor gain) {
  try {
    const CylinderRecording prepared = prepare_recording(recording, rig, judged_s);
    const double misfit = Balances(rig, prepared).misfit(gain);
    return std::isfinite(misfit) ? misfit : std::numeric_limits<double>::infinity();
  } catch (const std::exception&) { return std::numeric_limits<double>::infinity(); }
}

}  // namespace

double balance_misfit(const Rig& rig, const Recording& recording, double judged_s) {
  return misfit_of(rig, recording, judged_s, Factor::free);
}

double gas_misfit(const Rig& rig, const Recording& recording, double judged_s) {
  return misfit_of(rig, recording, judged_s, Factor::one);
}

}  // namespace pneuservo
