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

FlowFeedforward::Flow FlowFeedforward::flow(const ReferencePoint& motion, double p1_Pa, double p2_Pa,
                                            double measured_Pa) const noexcept {
  const double x = motion.d[0], v = motion.d[1], a = motion.d[2], j = motion.d[3];
  const double a1 = side_1_.area_m2, a2 = side_2_.area_m2;
  const double v1 = std::max(side_1_.middle_volume_m3 + a1 * x, side_1_.dead_volume_m3);
  const double v2 = std::max(side_2_.middle_volume_m3 - a2 * x, side_2_.dead_volume_m3);
  const double per_vt1 = 1.0 / (v1 + side_1_.line_volume_m3), per_vt2 = 1.0 / (v2 + side_2_.line_volume_m3);
  // Force rate wanted, plus what the motion itself takes away by compression (polytropic, line storage included).
  const double wanted =
      mass_kg_ * j + viscous_Ns_per_m_ * a + n * v * (a1 * a1 * p1_Pa * per_vt1 + a2 * a2 * p2_Pa * per_vt2);
  return {wanted,
          measured_Pa > atmosphere_Pa_ ? measured_Pa : supply_Pa_,
          {p1_Pa, p2_Pa},
          {per_vt1, per_vt2},
          {v1 * per_vt1, v2 * per_vt2},
          {p1_Pa * a1 * v, -p2_Pa * a2 * v}};
}

FlowFeedforward::Spool FlowFeedforward::spool(const Flow& flow, const std::array<double, 2>& loss_Pa) const noexcept {
  const bool fills_1 = flow.wanted >= 0.0;
  const double g1 = flux(flow.chamber_Pa[0] + loss_Pa[0], flow.supply_Pa, fills_1),
               g2 = flux(flow.chamber_Pa[1] + loss_Pa[1], flow.supply_Pa, !fills_1);
  const double per_n_r_t = 1.0 / (n * gas_R_T_);
  return {
      flow.wanted * per_n_r_t /
          (side_1_.area_m2 * g1 * flow.inverse_volume_per_m3[0] + side_2_.area_m2 * g2 * flow.inverse_volume_per_m3[1]),
      {g1, g2}};
}

// Twice at the mean of port and chamber flow, for the ports' pressures are not known before their losses.
std::array<double, 2> FlowFeedforward::loss_Pa(const Flow& flow) const noexcept {
  std::array<double, 2> loss{};
  for (int pass = 0; pass < 2; ++pass) {
    const auto [area, flux] = spool(flow, loss);
    const double valve_1 = area * flux[0], valve_2 = -area * flux[1];
    const double chamber_1 =
        (flow.swept_W[0] + flow.chamber_share[0] * (gas_R_T_ * valve_1 - flow.swept_W[0])) / gas_R_T_;
    const double chamber_2 =
        (flow.swept_W[1] + flow.chamber_share[1] * (gas_R_T_ * valve_2 - flow.swept_W[1])) / gas_R_T_;
    loss = {steady_line_loss_Pa(side_1_.line, 0.5 * (chamber_1 + valve_1), flow.chamber_Pa[0]),
            steady_line_loss_Pa(side_2_.line, 0.5 * (chamber_2 + valve_2), flow.chamber_Pa[1])};
  }
  return loss;
}

double FlowFeedforward::area_m2(const ReferencePoint& ahead, double p1_Pa, double p2_Pa,
                                double supply_Pa) const noexcept {
  const Flow wanted = flow(ahead, p1_Pa, p2_Pa, supply_Pa);
  return spool(wanted, loss_Pa(wanted)).area_m2;
}

std::array<double, 2> FlowFeedforward::line_loss_Pa(const ReferencePoint& now, double p1_Pa,
                                                    double p2_Pa) const noexcept {
  return loss_Pa(flow(now, p1_Pa, p2_Pa, supply_Pa_));
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
