// Plan of the flatness feedforward: chambers from the reference, sides by their inverse, valves, spools and hold.
#include <algorithm>
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

/// Both chambers at the fine times: force balance of the slider at constant mean pressure.
struct Chambers {
  SideMotion side_1, side_2;

  Chambers(const AxisParameters<double>& axis, const Reference& reference, const FlatnessSettings& settings,
           std::size_t n)
      : side_1(n), side_2(n) {
    const auto& c = axis.cylinder;
    const double m = axis.slider.mass_kg + axis.slider.payload_kg, B = axis.slider.viscous_friction_Ns_per_m;
    const double step_s = settings.period_s / fine_steps, area_sum = c.area_1_m2 + c.area_2_m2;
    const double rod_N = (c.area_1_m2 - c.area_2_m2) * axis.air.atmosphere_Pa, half_stroke = 0.5 * c.stroke_m;
    for (std::size_t i = 0; i < n; ++i) {
      const double t = (static_cast<double>(i) - static_cast<double>(margin)) * step_s + settings.command_delay_s;
      const auto d = reference.at(t).d;
      // A_1 p_1 - A_2 p_2 = F, p_1 + p_2 = 2 p_m.
      const double force = m * d[2] + B * d[1] + rod_N, force_rate = m * d[3] + B * d[2];
      side_1.pressure_Pa[i] = (force + 2.0 * c.area_2_m2 * settings.mean_pressure_Pa) / area_sum;
      side_2.pressure_Pa[i] = 2.0 * settings.mean_pressure_Pa - side_1.pressure_Pa[i];
      side_1.pressure_rate_Paps[i] = force_rate / area_sum;
      side_2.pressure_rate_Paps[i] = -side_1.pressure_rate_Paps[i];
      side_1.distance_m[i] = half_stroke + d[0];
      side_2.distance_m[i] = half_stroke - d[0];
      side_1.speed_mps[i] = d[1];
      side_2.speed_mps[i] = -d[1];
    }
  }
};

/// One valve behind its line: spool position for a flow, and the command that brings the spool there.
class ValveInverse {
 public:
  ValveInverse(const AxisParameters<double>& axis, const PortMotion& port, double period_s)
      : air_(axis.air), valve_(axis.valve), supply_Pa_(axis.supply.pressure_Pa), period_s_(period_s), port_(port),
        spool_V_(port.flow_kgps.size()) {
    for (std::size_t i = 0; i < spool_V_.size(); ++i) spool_V_[i] = at(i).spool_V(port.flow_kgps[i]);
    const double step_s = period_s / fine_steps;
    SmoothingDifferentiator(std::max(8, static_cast<int>(std::lround(window_s / step_s))), step_s)(spool_V_,
                                                                                                   spool_rate_Vps_);
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

std::vector<FlatnessTick> plan(const AxisParameters<double>& axis, const Reference& reference, double duration_s,
                               const FlatnessSettings& settings) {
  const auto count = static_cast<std::size_t>(std::max(1LL, std::llround(duration_s / settings.period_s)));
  const std::size_t n = fine_steps * count + 2 * margin + 1;
  const double step_s = settings.period_s / fine_steps;
  const auto& c = axis.cylinder;
  const Chambers chambers(axis, reference, settings, n);
  const ChamberGeometry<double> geometry_1{c.area_1_m2, c.dead_volume_1_m3, c.wall_heat_W_per_m2K};
  const ChamberGeometry<double> geometry_2{c.area_2_m2, c.dead_volume_2_m3, c.wall_heat_W_per_m2K};
  const auto inverse = [&](const LineParameters<double>& line, const ChamberGeometry<double>& geometry,
                           const SideMotion& motion) {
    return FlatnessSide(axis.air, line, geometry, settings.cells, step_s, window_s).invert(motion, settings.passes);
  };
  const PortMotion port_1 = inverse(axis.line_1, geometry_1, chambers.side_1);
  const PortMotion port_2 = inverse(axis.line_2, geometry_2, chambers.side_2);
  const ValveInverse valve_1(axis, port_1, settings.period_s), valve_2(axis, port_2, settings.period_s);
  std::vector<FlatnessTick> ticks(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t begin = margin + fine_steps * k, middle = begin + fine_steps / 2;
    FlatnessTick& tick = ticks[k];
    tick.valve_1 = valve_1.tick(begin);
    tick.valve_2 = valve_2.tick(begin);
    tick.mean_port_pressure_Pa = 0.5 * (port_1.pressure_Pa[begin] + port_2.pressure_Pa[begin]);
    tick.valve_1.volume_share =
        geometry_1.volume_m3(chambers.side_1.distance_m[middle]) / geometry_1.volume_m3(0.5 * c.stroke_m);
    tick.valve_2.volume_share =
        geometry_2.volume_m3(chambers.side_2.distance_m[middle]) / geometry_2.volume_m3(0.5 * c.stroke_m);
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
  const double limit_V = largest_command_V(axis.valve);
  const auto suffices = [&](double p) {
    coarse.mean_pressure_Pa = p;
    return peak_V(plan(axis, reference, duration_s, coarse)) <= limit_V;
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
    : ticks_(plan(axis, reference, duration_s, settings)) {
  peak_command_V_ = peak_V(ticks_);
  const double limit_V = largest_command_V(axis.valve);
  if (peak_command_V_ <= limit_V) return;
  const double needed = mean_pressure_needed_Pa(axis, reference, duration_s, settings);
  const std::string found = "mean_pressure_Pa " + number_text(settings.mean_pressure_Pa) +
                            " does not suffice for the reference: its feedforward would reach " +
                            number_text(std::round(peak_command_V_ * 100.0) / 100.0) + " V of " + number_text(limit_V) +
                            " V; ";
  throw std::invalid_argument(found + (needed > 0.0 ? "expected at least " + number_text(needed)
                                                    : std::string("no mean pressure below the supply suffices")));
}

}  // namespace pneuservo
