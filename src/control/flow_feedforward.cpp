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

FlowFeedforward::FlowFeedforward(const AxisParameters<double>& axis) noexcept {
  const Air<double> air(axis.air);
  const auto& cylinder = axis.cylinder;
  area_m2_ = join(cylinder.area_1_m2, cylinder.area_2_m2);
  moved_area_m2_ = join(cylinder.area_1_m2, -cylinder.area_2_m2);
  dead_volume_m3_ = join(cylinder.dead_volume_1_m3, cylinder.dead_volume_2_m3);
  middle_volume_m3_ = dead_volume_m3_ + area_m2_ * Lanes(0.5) * Lanes(cylinder.stroke_m);
  const auto held_m3 = [](const LineParameters<double>& line) { return line.section_m2() * line.length_m; };
  line_volume_m3_ = join(held_m3(axis.line_1), held_m3(axis.line_2));
  auto lines = cast<LineParameters<Lanes>>(axis.line_1);
  set_parameters_lane(lines, 1, axis.line_2);
  lines_ = SteadyLine<Lanes>(Air<Lanes>(cast<AirParameters<Lanes>>(axis.air)), lines);
  mass_kg_ = axis.slider.mass_kg + axis.slider.payload_kg;
  viscous_Ns_per_m_ = axis.slider.viscous_friction_Ns_per_m;
  volt_per_area_ = 1.0 / axis.valve.area_per_volt_m2_per_V;
  gas_R_T_ = air.R * air.temperature_K;
  flux_per_pressure_ = air.flow_constant / std::sqrt(gas_R_T_);
  supply_Pa_ = axis.supply.pressure_Pa;
  atmosphere_Pa_ = air.atmosphere_Pa;
  critical_pressure_ratio_ = axis.valve.critical_pressure_ratio;
}

// The side that fills takes from the supply, the other one empties to the atmosphere.
FlowFeedforward::Lanes FlowFeedforward::flux(const Lanes& port_Pa, double supply_Pa, bool side_1_fills) const noexcept {
  const auto fills = (side_1_fills ? join(1.0, 0.0) : join(0.0, 1.0)) > Lanes(0);
  const Lanes bounded_Pa = select(fills, minimum(port_Pa, Lanes(fill_ratio_max * supply_Pa)),
                                  maximum(port_Pa, Lanes(empty_ratio_min * atmosphere_Pa_)));
  return Lanes(flux_per_pressure_) * orifice_pressure_psi(select(fills, Lanes(supply_Pa), bounded_Pa),
                                                          select(fills, bounded_Pa, Lanes(atmosphere_Pa_)),
                                                          Lanes(critical_pressure_ratio_));
}

// The mean of a line's flow at valve and chamber: dp/dt is the same in both volumes, so the chamber takes its share of
// the valve's flow, and the piston sweeps the rest of its own through the line.
FlowFeedforward::Flow FlowFeedforward::flow(const ReferencePoint& motion, double p1_Pa, double p2_Pa,
                                            double measured_Pa) const noexcept {
  const double x = motion.d[0], v = motion.d[1], a = motion.d[2], j = motion.d[3];
  const Lanes p_Pa = join(p1_Pa, p2_Pa);
  const Lanes chamber_m3 = maximum(middle_volume_m3_ + moved_area_m2_ * Lanes(x), dead_volume_m3_);
  const Lanes per_volume = Lanes(1) / (chamber_m3 + line_volume_m3_);
  // Force rate wanted, plus what the motion itself takes away by compression (polytropic, line storage included).
  const Lanes stiffness = area_m2_ * area_m2_ * p_Pa * per_volume;
  const double wanted = mass_kg_ * j + viscous_Ns_per_m_ * a + n * v * (stiffness[0] + stiffness[1]);
  const Lanes chamber_share = chamber_m3 * per_volume;
  const Lanes swept_kgps = p_Pa * moved_area_m2_ * Lanes(v) * Lanes(1.0 / gas_R_T_);
  return {wanted,
          measured_Pa > atmosphere_Pa_ ? measured_Pa : supply_Pa_,
          p_Pa,
          area_m2_ * per_volume,
          Lanes(0.5) * swept_kgps * (Lanes(1) - chamber_share),
          Lanes(0.5) * (Lanes(1) + chamber_share)};
}

FlowFeedforward::Spool FlowFeedforward::spool(const Flow& flow, const Lanes& loss_Pa) const noexcept {
  const Lanes g = flux(flow.chamber_Pa + loss_Pa, flow.supply_Pa, flow.wanted >= 0.0);
  const Lanes rate_per_area = flow.area_per_volume_per_m * g;
  return {flow.wanted * (1.0 / (n * gas_R_T_)) / (rate_per_area[0] + rate_per_area[1]), g};
}

// Twice, for the ports' pressures are not known before their losses.
FlowFeedforward::Lanes FlowFeedforward::loss_Pa(const Flow& flow) const noexcept {
  Lanes loss;
  for (int pass = 0; pass < 2; ++pass) {
    const auto [area, flux] = spool(flow, loss);
    const Lanes valve_kgps = join(area, -area) * flux;
    loss = steady_line_loss_Pa(lines_, flow.mean_of_swept_kgps + flow.mean_of_valve * valve_kgps, flow.chamber_Pa);
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
  const Lanes loss = loss_Pa(flow(now, p1_Pa, p2_Pa, supply_Pa_));
  return {loss[0], loss[1]};
}

double feedforward_lead_s(const AxisParameters<double>& axis, double peak_speed_mps, double mean_pressure_Pa) noexcept {
  const Air<double> air(axis.air);
  const double r_t = air.R * air.temperature_K;
  const auto lead = [&](double area_m2, double dead_m3, const LineParameters<double>& line) {
    const double flow = 0.7 * area_m2 * mean_pressure_Pa * std::fabs(peak_speed_mps) / r_t;
    if (!(flow > 0.0)) return 0.0;
    const SteadyLine<double> steady(air, line);
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
