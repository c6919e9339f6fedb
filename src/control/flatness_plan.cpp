// Plan of the flatness feedforward: chambers from the reference, sides by their inverse, valves, spools and hold.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include <pneuservo/control/flatness_plan.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/rig/axis.hpp>

#include "config/number_text.hpp"
#include "control/flatness_side.hpp"

namespace pneuservo {
namespace {
constexpr int fine_steps = 4;              // of a period
constexpr double window_s = 0.8e-3;        // half width of the differentiator: +-16 steps at 200 us
constexpr double least_psi = 0.02;         // below it the spool that a flow needs would have no bound
constexpr std::size_t margin = 64;         // fine steps of rest before t = 0 and after the last tick

/// 120 s at 200 us: 1.2 GB and half a minute of work before the start.
constexpr std::size_t plan_ticks_max = 600000;

/// x, v, a and jerk at the fine times.
using Motion = std::vector<std::array<double, 4>>;

double fine_time_s(std::size_t i, const FlatnessSettings& settings) noexcept {
  return (static_cast<double>(i) - static_cast<double>(margin)) * settings.period_s / fine_steps +
         settings.command_delay_s;
}

Motion motion_of(const Reference& reference, double duration_s, const FlatnessSettings& settings) {
  const double wanted = std::round(duration_s / settings.period_s);
  if (wanted > static_cast<double>(plan_ticks_max))
    throw std::invalid_argument("the feedforward flatness plans each tick of " + number_text(duration_s) +
                                " s before the start, expected at most " +
                                number_text(static_cast<double>(plan_ticks_max) * settings.period_s) +
                                " s: a shorter duration_s, repeated by --moves");
  const auto ticks = static_cast<std::size_t>(std::max(1.0, wanted));
  Motion motion(fine_steps * ticks + 2 * margin + 1);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const auto d = reference.at(fine_time_s(i, settings)).d;
    std::copy_n(d.begin(), 4, motion[i].begin());
  }
  return motion;
}

std::size_t ticks_of(const Motion& motion) noexcept { return (motion.size() - 1 - 2 * margin) / fine_steps; }

/// Adds a deviation sampled at the ticks, smoothed by a Gaussian, with its derivatives. It rests before and after.
void add_deviation(Motion& motion, const std::vector<double>& error_m, const FlatnessSettings& settings) {
  const double s = FlatnessPlan::deviation_smoothing_s, period_s = settings.period_s;
  const auto last = static_cast<std::ptrdiff_t>(error_m.size()) - 1;
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(5.0 * s / period_s));
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const double at = fine_time_s(i, settings) / period_s;
    const auto nearest = static_cast<std::ptrdiff_t>(std::lround(at));
    std::array<double, 4> sum{};
    double weights = 0.0;
    const double middle = error_m[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(nearest, 0, last))];
    for (std::ptrdiff_t k = nearest - reach; k <= nearest + reach; ++k) {
      const double z = (at - static_cast<double>(k)) * period_s / s, weight = std::exp(-0.5 * z * z);
      // Derivatives of the Gaussian: Hermite polynomials. The middle value is taken off first: it has no derivative.
      const double e = error_m[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))] - middle;
      weights += weight;
      sum[0] += weight * e;
      sum[1] -= weight * e * z;
      sum[2] += weight * e * (z * z - 1.0);
      sum[3] -= weight * e * z * (z * z - 3.0);
    }
    double scale = 1.0 / weights;
    motion[i][0] += middle;
    for (std::size_t order = 0; order < 4; ++order, scale /= s) motion[i][order] += scale * sum[order];
  }
}

/// Both chambers at the fine times: force balance of the slider at constant mean pressure.
struct Chambers {
  SideMotion side_1, side_2;

  Chambers(const AxisParameters<double>& axis, const Motion& motion, double mean_pressure_Pa)
      : side_1(motion.size()), side_2(motion.size()) {
    const auto& c = axis.cylinder;
    const double m = axis.slider.mass_kg + axis.slider.payload_kg, B = axis.slider.viscous_friction_Ns_per_m;
    const double area_sum = c.area_1_m2 + c.area_2_m2, half_stroke = 0.5 * c.stroke_m;
    const double rod_N = (c.area_1_m2 - c.area_2_m2) * axis.air.atmosphere_Pa;
    for (std::size_t i = 0; i < motion.size(); ++i) {
      const auto& d = motion[i];
      // A_1 p_1 - A_2 p_2 = F, p_1 + p_2 = 2 p_m.
      const double force = m * d[2] + B * d[1] + rod_N, force_rate = m * d[3] + B * d[2];
      side_1.pressure_Pa[i] = (force + 2.0 * c.area_2_m2 * mean_pressure_Pa) / area_sum;
      side_2.pressure_Pa[i] = 2.0 * mean_pressure_Pa - side_1.pressure_Pa[i];
      side_1.pressure_rate_Paps[i] = force_rate / area_sum;
      side_2.pressure_rate_Paps[i] = -side_1.pressure_rate_Paps[i];
      side_1.distance_m[i] = half_stroke + d[0];
      side_2.distance_m[i] = half_stroke - d[0];
      side_1.speed_mps[i] = d[1];
      side_2.speed_mps[i] = -d[1];
    }
  }
};

SmoothingDifferentiator differentiator(double step_s) {
  return {std::max(8, static_cast<int>(std::lround(window_s / step_s))), step_s};
}

/// One valve behind its line: spool position for a flow, and the command that brings the spool there.
class ValveInverse {
 public:
  ValveInverse(const AxisParameters<double>& axis, const PortMotion& port, double period_s)
      : air_(axis.air), valve_(axis.valve), supply_Pa_(axis.supply.pressure_Pa), period_s_(period_s), port_(port),
        spool_V_(port.flow_kgps.size()) {
    for (std::size_t i = 0; i < spool_V_.size(); ++i) spool_V_[i] = at(i).spool_V(port.flow_kgps[i]);
    differentiator(period_s / fine_steps)(spool_V_, spool_rate_Vps_);
  }
  /// The period whose hold begins at fine step `begin`.
  FlatnessValve tick(std::size_t begin) const {
    const std::size_t middle = begin + fine_steps / 2, end = begin + fine_steps;
    FlatnessValve out = at(middle);
    double mean = 0.5 * (spool_V_[begin] + spool_V_[end]);
    for (std::size_t i = begin + 1; i < end; ++i) mean += spool_V_[i];
    double command = mean / fine_steps;
    if (valve_.natural_frequency_Hz > 0.0) {
      // s'' + 2 zeta w s' + w^2 s = w^2 u, integrated over the period of constant u.
      const double w = 2.0 * M_PI * valve_.natural_frequency_Hz, rate = 1.0 / (w * period_s_);
      command += 2.0 * valve_.damping_ratio * rate * (spool_V_[end] - spool_V_[begin]) +
                 rate / w * (spool_rate_Vps_[end] - spool_rate_Vps_[begin]);
    }
    out.correction_V = command - spool_V_[middle];
    return out;
  }

 private:
  // Flows per volt at a fine time; the orifices' equations in the model's own form.
  FlatnessValve at(std::size_t i) const {
    const double p = port_.pressure_Pa[i], b = valve_.critical_pressure_ratio;
    const auto flux = [&](double p_up, double T_up, double p_down) {
      const double psi = std::max(orifice_psi(std::min(p_down / p_up, 1.0), b), least_psi);
      return air_.flow_constant * p_up / std::sqrt(air_.R * T_up) * psi * valve_.area_per_volt_m2_per_V;
    };
    FlatnessValve out;
    out.flow_kgps = port_.flow_kgps[i];
    out.charge_kgps_per_V = flux(supply_Pa_, air_.temperature_K, p);
    out.discharge_kgps_per_V = flux(p, port_.temperature_K[i], air_.atmosphere_Pa);
    return out;
  }

  Air<double> air_;
  ValveParameters<double> valve_;
  double supply_Pa_, period_s_;
  const PortMotion& port_;
  std::vector<double> spool_V_, spool_rate_Vps_;
};

/// Both valves' ports for a motion.
struct Ports {
  PortMotion port_1, port_2;

  Ports(const AxisParameters<double>& axis, const Chambers& chambers, const FlatnessSettings& settings) {
    const double step_s = settings.period_s / fine_steps;
    const auto& c = axis.cylinder;
    const FlatnessSide side_1(axis.air, axis.line_1, {c.area_1_m2, c.dead_volume_1_m3, c.wall_heat_W_per_m2K},
                              settings.cells, step_s, differentiator(step_s));
    const FlatnessSide side_2(axis.air, axis.line_2, {c.area_2_m2, c.dead_volume_2_m3, c.wall_heat_W_per_m2K},
                              settings.cells, step_s, differentiator(step_s));
    port_1 = side_1.invert(chambers.side_1, settings.passes);
    port_2 = side_2.invert(chambers.side_2, settings.passes);
  }
};

double volume_share(const CylinderParameters<double>& c, double area_m2, double dead_m3, double distance_m) noexcept {
  return (dead_m3 + area_m2 * distance_m) / (dead_m3 + 0.5 * area_m2 * c.stroke_m);
}

std::vector<FlatnessTick> plan(const AxisParameters<double>& axis, const Motion& motion,
                               const FlatnessSettings& settings) {
  const auto& c = axis.cylinder;
  const Chambers chambers(axis, motion, settings.mean_pressure_Pa);
  const Ports ports(axis, chambers, settings);
  const ValveInverse valve_1(axis, ports.port_1, settings.period_s), valve_2(axis, ports.port_2, settings.period_s);
  std::vector<FlatnessTick> ticks(ticks_of(motion));
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    const std::size_t begin = margin + fine_steps * k, middle = begin + fine_steps / 2;
    FlatnessTick& tick = ticks[k];
    tick.valve_1 = valve_1.tick(begin);
    tick.valve_2 = valve_2.tick(begin);
    tick.mean_port_pressure_Pa = 0.5 * (ports.port_1.pressure_Pa[begin] + ports.port_2.pressure_Pa[begin]);
    tick.valve_1.volume_share = volume_share(c, c.area_1_m2, c.dead_volume_1_m3, chambers.side_1.distance_m[middle]);
    tick.valve_2.volume_share = volume_share(c, c.area_2_m2, c.dead_volume_2_m3, chambers.side_2.distance_m[middle]);
  }
  return ticks;
}

double peak_V(const std::vector<FlatnessTick>& ticks) noexcept {
  double peak = 0.0;
  for (const FlatnessTick& tick : ticks)
    for (const FlatnessValve* valve : {&tick.valve_1, &tick.valve_2})
      peak = std::max(peak, std::fabs(valve->command_V(0.0)));
  return peak;
}

// The range, and the area that the widest spool opens.
double largest_command_V(const ValveParameters<double>& valve) noexcept {
  return std::min(valve.command_max_V, valve.area_max_m2 / valve.area_per_volt_m2_per_V);
}

}  // namespace

double mean_pressure_needed_Pa(const AxisParameters<double>& axis, const Reference& reference, double duration_s,
                               const FlatnessSettings& settings) {
  constexpr double resolution_Pa = 500.0;
  FlatnessSettings coarse = settings;  // the peak needs no fine grid
  coarse.period_s = std::max(settings.period_s, 1e-3);
  coarse.cells = 2;
  coarse.passes = 1;
  const Motion motion = motion_of(reference, duration_s, coarse);
  const double limit_V = largest_command_V(axis.valve);
  const auto suffices = [&](double p) {
    coarse.mean_pressure_Pa = p;
    return peak_V(plan(axis, motion, coarse)) <= limit_V;
  };
  // Too low a pressure cannot exhaust, too high a one cannot be charged: look from below for the first that will do.
  const double step_Pa = 20.0 * resolution_Pa, top_Pa = axis.supply.pressure_Pa;
  double low_Pa = axis.air.atmosphere_Pa, high_Pa = low_Pa + step_Pa;
  while (high_Pa < top_Pa && !suffices(high_Pa)) {
    low_Pa = high_Pa;
    high_Pa += step_Pa;
  }
  if (!(high_Pa < top_Pa)) return 0.0;
  while (high_Pa - low_Pa > resolution_Pa) {
    const double middle = 0.5 * (low_Pa + high_Pa);
    (suffices(middle) ? high_Pa : low_Pa) = middle;
  }
  return std::ceil(high_Pa / resolution_Pa) * resolution_Pa;
}

FlatnessPlan::FlatnessPlan(const AxisParameters<double>& axis, const Reference& reference, double duration_s,
                           const FlatnessSettings& settings)
    : reference_(reference), duration_s_(duration_s), settings_(settings),
      ticks_(plan(axis, motion_of(reference, duration_s, settings), settings)) {
  peak_command_V_ = peak_V(ticks_);
  const double limit_V = largest_command_V(axis.valve);
  if (peak_command_V_ <= limit_V) return;
  // Found on a coarse grid, so tried on the plan's own before it is recommended.
  FlatnessSettings remedy = settings;
  remedy.mean_pressure_Pa = mean_pressure_needed_Pa(axis, reference, duration_s, settings);
  const double needed = remedy.mean_pressure_Pa;
  const bool suffices = needed > 0.0 && peak_V(plan(axis, motion_of(reference, duration_s, remedy), remedy)) <= limit_V;
  const std::string found = "mean_pressure_Pa " + number_text(settings.mean_pressure_Pa) +
                            " does not suffice for the reference: its feedforward would reach " +
                            number_text(std::round(peak_command_V_ * 100.0) / 100.0) + " V of " + number_text(limit_V) +
                            " V; ";
  throw std::invalid_argument(
      found + (suffices ? "expected at least " + number_text(needed)
                        : std::string("no mean pressure below the supply was found that does, expected a reference "
                                      "with less acceleration (longer ramps)")));
}

std::vector<double> FlatnessPlan::flow_of_deviation(const AxisParameters<double>& axis,
                                                    const std::vector<double>& error_m) const {
  Motion motion = motion_of(reference_, duration_s_, settings_);
  add_deviation(motion, error_m, settings_);
  const Ports ports(axis, Chambers(axis, motion, settings_.mean_pressure_Pa), settings_);
  std::vector<double> flow(ticks_.size()), rate, curvature;
  for (std::size_t k = 0; k < flow.size(); ++k) {
    const std::size_t middle = margin + fine_steps * k + fine_steps / 2;
    flow[k] = 0.5 * (ports.port_1.flow_kgps[middle] - ticks_[k].valve_1.flow_kgps -
                     (ports.port_2.flow_kgps[middle] - ticks_[k].valve_2.flow_kgps));
  }
  if (!(axis.valve.natural_frequency_Hz > 0.0)) return flow;
  const SmoothingDifferentiator differentiate = differentiator(settings_.period_s);
  differentiate(flow, rate);
  differentiate(rate, curvature);
  const double w = 2.0 * M_PI * axis.valve.natural_frequency_Hz;
  for (std::size_t k = 0; k < flow.size(); ++k)
    flow[k] += 2.0 * axis.valve.damping_ratio / w * rate[k] + curvature[k] / (w * w);
  return flow;
}

}  // namespace pneuservo
