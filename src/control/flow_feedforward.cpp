// Flow feedforward: constants of an axis, the area by three passes, the recommended lead.
#include <algorithm>

#include <pneuservo/control/flow_feedforward.hpp>
#include <pneuservo/rig/axis.hpp>

namespace pneuservo {

namespace {
constexpr double n = feedforward_polytropic_exponent;
/// psi is never asked closer to equal pressures than this: the area for a flow stays bounded there.
constexpr double fill_ratio_max = 0.995, empty_ratio_min = 1.01;
}  // namespace

SteadyLine::SteadyLine(const Air<double>& air, const LineParameters<double>& line) noexcept : friction(line, air) {
  const double section_m2 = line.section_m2();
  reynolds_per_flow = line.diameter_m / (section_m2 * air.viscosity_Pas);
  loss_constant = air.viscosity_Pas * line.length_m * air.R * air.temperature_K /
                  (2.0 * line.diameter_m * line.diameter_m * section_m2);
}

FlowFeedforward::FlowFeedforward(const AxisParameters<double>& axis) noexcept {
  const Air<double> air(axis.air);
  const auto& cylinder = axis.cylinder;
  const auto side = [&](double area_m2, double dead_m3, const LineParameters<double>& line) {
    return Side{area_m2, dead_m3 + area_m2 * 0.5 * cylinder.stroke_m, dead_m3, line.section_m2() * line.length_m,
                SteadyLine(air, line)};
  };
  side_1_ = side(cylinder.area_1_m2, cylinder.dead_volume_1_m3, axis.line_1);
  side_2_ = side(cylinder.area_2_m2, cylinder.dead_volume_2_m3, axis.line_2);
  mass_kg_ = axis.slider.mass_kg + axis.slider.payload_kg;
  viscous_Ns_per_m_ = axis.slider.viscous_friction_Ns_per_m;
  volt_per_area_ = 1.0 / axis.valve.area_per_volt_m2_per_V;
  gas_R_T_ = air.R * air.temperature_K;
  flux_per_pressure_ = air.flow_constant / std::sqrt(gas_R_T_);
  supply_Pa_ = axis.supply.pressure_Pa;
  atmosphere_Pa_ = air.atmosphere_Pa;
  critical_pressure_ratio_ = axis.valve.critical_pressure_ratio;
}

double FlowFeedforward::flux(double port_Pa, double supply_Pa, bool fills) const noexcept {
  if (fills) {
    const double ratio = std::min(port_Pa / supply_Pa, fill_ratio_max);
    return flux_per_pressure_ * supply_Pa * orifice_psi(ratio, critical_pressure_ratio_);
  }
  const double upstream_Pa = std::max(port_Pa, empty_ratio_min * atmosphere_Pa_);
  return flux_per_pressure_ * upstream_Pa * orifice_psi(atmosphere_Pa_ / upstream_Pa, critical_pressure_ratio_);
}

SpoolDemand FlowFeedforward::demand(const ReferencePoint& motion, double p1_Pa, double p2_Pa,
                                    double measured_Pa) const noexcept {
  const double supply_Pa = measured_Pa > atmosphere_Pa_ ? measured_Pa : supply_Pa_;
  const double x = motion.d[0], v = motion.d[1], a = motion.d[2], j = motion.d[3];
  const double a1 = side_1_.area_m2, a2 = side_2_.area_m2;
  const double v1 = std::max(side_1_.middle_volume_m3 + a1 * x, side_1_.dead_volume_m3);
  const double v2 = std::max(side_2_.middle_volume_m3 - a2 * x, side_2_.dead_volume_m3);
  const double per_vt1 = 1.0 / (v1 + side_1_.line_volume_m3), per_vt2 = 1.0 / (v2 + side_2_.line_volume_m3);
  // Force rate wanted, plus what the motion itself takes away by compression (polytropic, line storage included).
  const double wanted =
      mass_kg_ * j + viscous_Ns_per_m_ * a + n * v * (a1 * a1 * p1_Pa * per_vt1 + a2 * a2 * p2_Pa * per_vt2);
  const bool fills_1 = wanted >= 0.0;
  const double per_n_r_t = 1.0 / (n * gas_R_T_), swept_1 = p1_Pa * a1 * v, swept_2 = -p2_Pa * a2 * v;

  SpoolDemand out;
  auto& [area, loss] = out;
  for (int pass = 0;; ++pass) {
    const double g1 = flux(p1_Pa + loss[0], supply_Pa, fills_1), g2 = flux(p2_Pa + loss[1], supply_Pa, !fills_1);
    area = wanted * per_n_r_t / (a1 * g1 * per_vt1 + a2 * g2 * per_vt2);
    if (pass == 2) return out;
    // Line loss at the mean of port and chamber flow gives the next port pressures.
    const double valve_1 = area * g1, valve_2 = -area * g2;
    const double chamber_1 = (swept_1 + v1 * per_vt1 * (gas_R_T_ * valve_1 - swept_1)) / gas_R_T_;
    const double chamber_2 = (swept_2 + v2 * per_vt2 * (gas_R_T_ * valve_2 - swept_2)) / gas_R_T_;
    loss[0] = steady_line_loss_Pa(side_1_.line, 0.5 * (chamber_1 + valve_1), p1_Pa);
    loss[1] = steady_line_loss_Pa(side_2_.line, 0.5 * (chamber_2 + valve_2), p2_Pa);
  }
}

double feedforward_lead_s(const AxisParameters<double>& axis, double peak_speed_mps, double mean_pressure_Pa) noexcept {
  const Air<double> air(axis.air);
  const double r_t = air.R * air.temperature_K;
  const auto lead = [&](double area_m2, double dead_m3, const LineParameters<double>& line) {
    const double flow = 0.7 * area_m2 * mean_pressure_Pa * std::fabs(peak_speed_mps) / r_t;
    if (!(flow > 0.0)) return 0.0;
    const SteadyLine steady(air, line);
    const double resistance =
        1.75 * steady_line_loss_Pa(steady, flow, mean_pressure_Pa) / flow;  // d(loss)/dG, turbulent
    const double c_line = line.section_m2() * line.length_m / (n * r_t);
    const double c_chamber = (dead_m3 + area_m2 * 0.5 * axis.cylinder.stroke_m) / (n * r_t);
    return resistance * c_line * (c_chamber / 2.0 + c_line / 3.0) / (c_line + c_chamber);
  };
  return 0.5 * (lead(axis.cylinder.area_1_m2, axis.cylinder.dead_volume_1_m3, axis.line_1) +
                lead(axis.cylinder.area_2_m2, axis.cylinder.dead_volume_2_m3, axis.line_2));
}

}  // namespace pneuservo
