// Balances of gas and force under a supposed wiring.
#include "diagnosis/doubts/wiring_balance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <pneuservo/elements/orifice.hpp>

#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/residuals/gaussian_kernel.hpp"

namespace pneuservo {

namespace {

using Series = std::vector<double>;

constexpr double least_sigma_s = 0.02;  ///< a valve of 10 Hz and a line's first mode lie within
constexpr double sticking_share = 0.1;      ///< of the top speed: slower motion may stick

/// The last value goes on where there is none.
Series without_gaps(const Series& measured) {
  Series out = measured;
  for (std::size_t k = 1; k < out.size(); ++k)
    if (!std::isfinite(out[k])) out[k] = out[k - 1];
  return out;
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
      : rig_(rig), prepared_(prepared),
        kernel_(std::max({least_sigma_s + longest_m(rig) / Air<double>(rig.axis.air).sound_speed(),
                          2 * prepared.period_s()}),
                prepared.period_s()),
        x_m_(without_gaps(prepared.position_m)), v_mps_(kernel_.apply(x_m_, 1)) {
    double top_mps = 0;
    for (const double v : v_mps_) top_mps = std::max(top_mps, std::abs(v));
    const std::size_t reach = kernel_.reach();
    for (std::size_t k = reach; k + reach < v_mps_.size(); ++k) {
      if (!prepared.usable[k]) continue;
      rows_.push_back(k);
      if (std::abs(v_mps_[k]) > sticking_share * top_mps) moving_.push_back(k);
    }
  }

  /// Of the gas alone where the valve's gain is as stated.
  double misfit(Factor gain) const {
    if (moving_.size() < 10) return std::numeric_limits<double>::infinity();
    double sum = 0, count = 0;
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
      if (const auto left = gas(side, gain)) sum += *left, ++count;
    for (const auto& pair : {port_signals, chamber_signals})
      if (const auto left = gain == Factor::free ? force(pair) : std::nullopt) sum += *left, ++count;
    return count > 0 ? std::sqrt(sum / count) : std::numeric_limits<double>::infinity();
  }

 private:
  static double longest_m(const Rig& rig) { return std::max(rig.axis.line_1.length_m, rig.axis.line_2.length_m); }

  /// Of a side's port, else of its chamber; empty where neither is measured.
  Series measured(std::size_t side, bool at_chamber) const {
    const Series &port = prepared_.measured[port_signals[side]], &chamber = prepared_.measured[chamber_signals[side]];
    const Series &wished = at_chamber ? chamber : port, &other = at_chamber ? port : chamber;
    return without_gaps(wished.empty() ? other : wished);
  }

  std::optional<double> gas(std::size_t side, Factor gain) const {
    const Series port_Pa = measured(side, false), chamber_Pa = measured(side, true);
    if (port_Pa.empty()) return std::nullopt;
    const auto& cylinder = rig_.axis.cylinder;
    const auto& line = side == 0 ? rig_.axis.line_1 : rig_.axis.line_2;
    const double towards = side == 0 ? 1.0 : -1.0, area_m2 = side == 0 ? cylinder.area_1_m2 : cylinder.area_2_m2,
                 dead_m3 = side == 0 ? cylinder.dead_volume_1_m3 : cylinder.dead_volume_2_m3;
    const Air<double> air(rig_.axis.air);
    const double command_sign = side == 1 && !prepared_.inputs.has_two_valves() ? -1.0 : 1.0;
    Series mass_kg(x_m_.size()), flow_kgps(x_m_.size());
    for (std::size_t k = 0; k < x_m_.size(); ++k) {
      const double chamber_m3 = std::max(dead_m3 + area_m2 * (0.5 * cylinder.stroke_m + towards * x_m_[k]), dead_m3);
      mass_kg[k] = (chamber_Pa[k] * chamber_m3 + 0.5 * (port_Pa[k] + chamber_Pa[k]) * line.volume_m3()) /
                   (air.R * air.temperature_K);
      flow_kgps[k] = valve_flow(air, command_sign * prepared_.inputs.command_of(side)[k], supply_at(k), port_Pa[k]);
    }
    const Series wanted = kernel_.apply(mass_kg, 1);
    return left_share(wanted, kernel_.apply(flow_kgps, 0), rows_, square_of_swing(wanted, rows_), gain);
  }

  double supply_at(std::size_t k) const {
    return prepared_.inputs.supply_Pa.empty() ? rig_.axis.supply.pressure_Pa : prepared_.inputs.supply_Pa[k];
  }

  /// Into the side where the command is above 0.
  double valve_flow(const Air<double>& air, double command_V, double supply_Pa, double port_Pa) const {
    const auto& valve = rig_.axis.valve;
    const double area_m2 = valve.area_per_volt_m2_per_V * std::abs(command_V), T = air.temperature_K,
                 ratio = valve.critical_pressure_ratio;
    if (!(port_Pa > 0) || !std::isfinite(command_V)) return 0.0;
    return command_V > 0 ? orifice_mass_flow(air, area_m2, ratio, supply_Pa, T, port_Pa, T)
                         : orifice_mass_flow(air, area_m2, ratio, air.atmosphere_Pa, T, port_Pa, T);
  }

  std::optional<double> force(const std::array<Signal, 2>& at) const {
    if (prepared_.measured[at[0]].empty() || prepared_.measured[at[1]].empty()) return std::nullopt;
    const Series p1_Pa = without_gaps(prepared_.measured[at[0]]), p2_Pa = without_gaps(prepared_.measured[at[1]]);
    const auto& axis = rig_.axis;
    Series drive_N(p1_Pa.size()), direction(p1_Pa.size());
    for (std::size_t k = 0; k < drive_N.size(); ++k)
      drive_N[k] = axis.cylinder.area_1_m2 * p1_Pa[k] - axis.cylinder.area_2_m2 * p2_Pa[k];
    drive_N = kernel_.apply(drive_N, 0);
    const double swing = square_of_swing(drive_N, moving_);
    const Series acceleration = kernel_.apply(x_m_, 2);
    for (std::size_t k = 0; k < drive_N.size(); ++k) {
      drive_N[k] -= (axis.slider.mass_kg + axis.slider.payload_kg) * acceleration[k];
      direction[k] = v_mps_[k] > 0 ? 1.0 : -1.0;
    }
    return left_share(drive_N, direction, moving_, swing, Factor::free);
  }

  const Rig& rig_;
  const CylinderRecording& prepared_;
  GaussianKernel kernel_;
  Series x_m_, v_mps_;
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
