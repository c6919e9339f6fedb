// Flatness feedforward in the loop, and learning from a finished move.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include <pneuservo/control/flatness_law.hpp>
#include <pneuservo/control/linear_servo_table.hpp>
#include <pneuservo/elements/air.hpp>
#include <pneuservo/rig/axis.hpp>

#include "control/move_record.hpp"

namespace pneuservo {
namespace {
/// What is learned is smoothed by a Gaussian: beyond it, near the lines' resonances, the model knows too little.
constexpr double learning_smoothing_s = FlatnessPlan::deviation_smoothing_s;

std::vector<double> smoothed(const std::vector<double>& values, double period_s) {
  const auto n = static_cast<std::ptrdiff_t>(values.size());
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(5.0 * learning_smoothing_s / period_s));
  std::vector<double> weights;
  double sum = 0.0;
  for (std::ptrdiff_t i = -reach; i <= reach; ++i) {
    const double z = static_cast<double>(i) * period_s / learning_smoothing_s;
    weights.push_back(std::exp(-0.5 * z * z));
    sum += weights.back();
  }
  std::vector<double> out(values.size());
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    double value = 0.0;
    for (std::ptrdiff_t i = -reach; i <= reach; ++i)
      value += weights[static_cast<std::size_t>(i + reach)] *
               values[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k + i, 0, n - 1))];
    out[static_cast<std::size_t>(k)] = value / sum;
  }
  return out;
}
}  // namespace

FlatnessGains flatness_gains(const AxisParameters<double>& axis, double equilibrium_pressure_Pa,
                             double hold_rad_per_s) noexcept {
  const auto& c = axis.cylinder;
  const double area_m2 = 0.5 * (c.area_1_m2 + c.area_2_m2);
  const double volume_m3 = 0.5 * (c.dead_volume_1_m3 + c.dead_volume_2_m3 + area_m2 * c.stroke_m);
  const double gas_R_T = axis.air.gas_constant_J_per_kgK * axis.air.temperature_K;
  const double K = linear_servo_table(axis, equilibrium_pressure_Pa, {}).gain_per_V;
  const double mass_kg = axis.slider.mass_kg + axis.slider.payload_kg;
  return {K * mass_kg * volume_m3 / (2.0 * area_m2 * gas_R_T), hold_rad_per_s * volume_m3 / gas_R_T, 0.05};
}

FlatnessLaw::FlatnessLaw(FlatnessPlan plan, const FlatnessGains& gains, double period_s)
    : gains_(gains), period_s_(period_s), filter_share_(1.0 - std::exp(-period_s / gains.pressure_filter_s)) {
  set_plan(std::move(plan));
}

void FlatnessLaw::set_plan(FlatnessPlan plan) {
  plan_ = std::move(plan);
  error_m_.assign(plan_.ticks(), not_recorded);
  feedback_kgps_.assign(plan_.ticks(), not_recorded);
  learned_kgps_.assign(plan_.ticks(), 0.0);
}

FlatnessCommand FlatnessLaw::step(std::int64_t tick, double error_m, double feedback_V, double port_1_Pa,
                                  double port_2_Pa) noexcept {
  const FlatnessTick& now = plan_.at(tick);
  // Deviation from the feedforward's own mean: the lines' losses are in it.
  const double deviation_Pa = 0.5 * (port_1_Pa + port_2_Pa) - now.mean_port_pressure_Pa;
  mean_pressure_Pa_ =
      filter_started_ ? mean_pressure_Pa_ + filter_share_ * (deviation_Pa - mean_pressure_Pa_) : deviation_Pa;
  filter_started_ = true;
  const double hold_kgps = -gains_.pressure_hold_kgps_per_Pa * mean_pressure_Pa_;
  double across_kgps = gains_.flow_per_volt_kgps * feedback_V;
  if (tick >= 0 && static_cast<std::size_t>(tick) < feedback_kgps_.size()) {
    error_m_[static_cast<std::size_t>(tick)] = error_m;
    feedback_kgps_[static_cast<std::size_t>(tick)] = across_kgps;
    across_kgps += learned_kgps_[static_cast<std::size_t>(tick)];
  }
  // Another thread may be learning, and ends with this one number.
  const double per_area = 1.0 / std::atomic_ref(area_factor_).load(std::memory_order_relaxed);
  return {per_area * now.valve_1.command_V(across_kgps + now.valve_1.volume_share * hold_kgps),
          per_area * now.valve_2.command_V(-across_kgps + now.valve_2.volume_share * hold_kgps)};
}

// Feedforward and feedback together gave x_ref + e; for x_ref alone the flow of e is too much.
std::optional<std::vector<double>> FlatnessLaw::take_missing_flow(const AxisParameters<double>& axis) {
  std::optional<std::vector<double>> missing;
  const bool is_known = fill_skipped(error_m_) && fill_skipped(feedback_kgps_);
  if (is_known) {
    missing = smoothed(feedback_kgps_, period_s_);
    const std::vector<double> of_error = plan_.flow_of_deviation(axis, error_m_);
    for (std::size_t k = 0; k < of_error.size(); ++k) (*missing)[k] -= of_error[k];
  } else {
    ++moves_not_learned_;
  }
  error_m_.assign(error_m_.size(), not_recorded);
  feedback_kgps_.assign(feedback_kgps_.size(), not_recorded);
  return missing;
}

void FlatnessLaw::learn_flow(const AxisParameters<double>& axis) {
  const auto missing = take_missing_flow(axis);
  if (!missing) return;
  for (std::size_t k = 0; k < learned_kgps_.size(); ++k) learned_kgps_[k] += (*missing)[k];
}

// Missing flow = eps G_d in the least-squares sense, G_d the difference flow of the feedforward.
double FlatnessLaw::learn_area(const AxisParameters<double>& axis) {
  const auto missing = take_missing_flow(axis);
  if (!missing) return area_factor_;
  double across = 0.0, along = 0.0;
  for (std::size_t k = 0; k < missing->size(); ++k) {
    const FlatnessTick& tick = plan_.at(static_cast<std::int64_t>(k));
    const double flow = 0.5 * (tick.valve_1.flow_kgps - tick.valve_2.flow_kgps);
    across += (*missing)[k] * flow;
    along += flow * flow;
  }
  if (along > 0.0)
    std::atomic_ref(area_factor_).store(area_factor_ / (1.0 + across / along), std::memory_order_relaxed);
  return area_factor_;
}

}  // namespace pneuservo
