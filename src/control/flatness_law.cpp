// Flatness feedforward in the loop, and learning from a finished move.
#include <algorithm>
#include <cmath>

#include <pneuservo/control/flatness_law.hpp>
#include <pneuservo/control/linear_servo_table.hpp>
#include <pneuservo/elements/air.hpp>
#include <pneuservo/rig/axis.hpp>

namespace pneuservo {
namespace {
/// The loop answers a wrong flow this much later, and higher frequencies than the smoothing's it does not answer well.
constexpr double learning_lead_s = 2.5e-3, learning_smoothing_s = 3e-3;
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
  feedback_kgps_.assign(plan_.ticks(), 0.0);
  learned_kgps_.assign(plan_.ticks(), 0.0);
}

FlatnessCommand FlatnessLaw::step(std::int64_t tick, double feedback_V, double port_1_Pa, double port_2_Pa) noexcept {
  const FlatnessTick& now = plan_.at(tick);
  // Deviation from the feedforward's own mean: the lines' losses are in it.
  const double deviation_Pa = 0.5 * (port_1_Pa + port_2_Pa) - now.mean_port_pressure_Pa;
  mean_pressure_Pa_ =
      filter_started_ ? mean_pressure_Pa_ + filter_share_ * (deviation_Pa - mean_pressure_Pa_) : deviation_Pa;
  filter_started_ = true;
  const double hold_kgps = -gains_.pressure_hold_kgps_per_Pa * mean_pressure_Pa_;
  double across_kgps = gains_.flow_per_volt_kgps * feedback_V;
  if (tick >= 0 && static_cast<std::size_t>(tick) < feedback_kgps_.size()) {
    feedback_kgps_[static_cast<std::size_t>(tick)] = across_kgps;
    across_kgps += learned_kgps_[static_cast<std::size_t>(tick)];
  }
  const double per_area = 1.0 / area_factor_;
  return {per_area * now.valve_1.command_V(across_kgps + now.valve_1.volume_share * hold_kgps),
          per_area * now.valve_2.command_V(-across_kgps + now.valve_2.volume_share * hold_kgps)};
}

// G_learned(t) <- smooth(g(t + lead) + G_learned(t + lead)), a Gaussian; the ends are taken to go on as they are.
void FlatnessLaw::learn_flow() {
  const auto n = static_cast<std::ptrdiff_t>(learned_kgps_.size());
  const auto lead = static_cast<std::ptrdiff_t>(std::lround(learning_lead_s / period_s_));
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(4.0 * learning_smoothing_s / period_s_));
  std::vector<double> weights;
  double sum = 0.0;
  for (std::ptrdiff_t i = -reach; i <= reach; ++i) {
    const double z = static_cast<double>(i) * period_s_ / learning_smoothing_s;
    weights.push_back(std::exp(-0.5 * z * z));
    sum += weights.back();
  }
  std::vector<double> next(learned_kgps_.size());
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    double value = 0.0;
    for (std::ptrdiff_t i = -reach; i <= reach; ++i) {
      const auto at = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k + lead + i, 0, n - 1));
      value += weights[static_cast<std::size_t>(i + reach)] * (feedback_kgps_[at] + learned_kgps_[at]);
    }
    next[static_cast<std::size_t>(k)] = value / sum;
  }
  learned_kgps_.swap(next);
}

// g = eps G_d in the least-squares sense, G_d the difference flow of the feedforward.
double FlatnessLaw::learn_area() noexcept {
  double across = 0.0, along = 0.0;
  for (std::size_t k = 0; k < feedback_kgps_.size(); ++k) {
    const FlatnessTick& tick = plan_.at(static_cast<std::int64_t>(k));
    const double flow = 0.5 * (tick.valve_1.flow_kgps - tick.valve_2.flow_kgps);
    across += feedback_kgps_[k] * flow;
    along += flow * flow;
  }
  if (along > 0.0) area_factor_ /= 1.0 + across / along;
  return area_factor_;
}

}  // namespace pneuservo
