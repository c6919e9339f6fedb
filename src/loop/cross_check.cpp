// Cross-checks of the sensors against the model.
#include <pneuservo/loop/cross_check.hpp>

#include <algorithm>
#include <cmath>

#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/loop/fault.hpp>

namespace pneuservo {
namespace {

using Two = Pack<double, 2>;

/// Air of one side, line and chamber at mid-stroke, at supply pressure [kg].
double full_air_kg(const Rig& rig, const LineParameters<double>& line, double area_m2, double dead_volume_m3) {
  const double line_m3 = 0.25 * M_PI * line.diameter_m * line.diameter_m * line.length_m;
  const double volume_m3 = line_m3 + dead_volume_m3 + 0.5 * area_m2 * rig.axis.cylinder.stroke_m;
  const auto& air = rig.axis.air;
  return rig.axis.supply.pressure_Pa * volume_m3 / (air.gas_constant_J_per_kgK * air.temperature_K);
}

}  // namespace

void CrossCheck::configure(const Rig& rig) {
  const auto& axis = rig.axis;
  air_ = Air<Two>(cast<AirParameters<Two>>(axis.air));
  valves_.configure(valve_arrangement(rig), axis.valve, axis.effects.valve, rig.period_s);
  valves_.set_time_step(rig.period_s);
  period_s_ = rig.period_s;
  critical_ratio_ = axis.valve.critical_pressure_ratio;
  atmosphere_Pa_ = axis.air.atmosphere_Pa;
  flow_limit_share_ = rig.limits.flow_mismatch_share;
  chamber_limit_Pa_ = rig.limits.chamber_mismatch_Pa;
  const auto& e = axis.effects;
  leak_area_ = join(e.chamber_leak_1.area_m2 + e.line_leak_1.area_m2, e.chamber_leak_2.area_m2 + e.line_leak_2.area_m2);
  piston_leak_m2_ = e.piston_leak.area_m2;
  leak_zone_ = e.piston_leak_zone;
  const auto& c = axis.cylinder;
  floor_kg_ = join(floor_share * full_air_kg(rig, axis.line_1, c.area_1_m2, c.dead_volume_1_m3),
                   floor_share * full_air_kg(rig, axis.line_2, c.area_2_m2, c.dead_volume_2_m3));
  decay_ = std::exp(-rig.period_s / window_s);
  smoothing_ = -std::expm1(-rig.period_s / smoothing_s);
  settled_after_ = std::llround(settle_s / rig.period_s);
  reset();
}

void CrossCheck::reset() noexcept {
  valves_.reset(0.0);
  missing_kg_ = through_kg_ = difference_Pa_ = Two(0);
  ticks_ = 0;
  started_ = watching_ = false;
  flow_share_ = chamber_share_ = {};
}

// Mean over the period: the command was held, the port pressure went from the last sample to this one.
CrossCheck::Two CrossCheck::valve_flow(const CrossCheckInput& in) noexcept {
  valves_.set_commands(in.command_V[0], in.command_V[1]);
  const PortAreas<Two> areas = valves_.step(0.0);
  const Two now = join(in.port_Pa[0], in.port_Pa[1]), middle = Two(0.5) * (now + port_Pa_);
  port_Pa_ = now;
  const Two b(critical_ratio_), T = air_.temperature_K;
  return orifice_mass_flow(air_, areas.supply, b, Two(in.supply_Pa), T, middle, T) -
         orifice_mass_flow(air_, areas.exhaust, b, middle, T, Two(atmosphere_Pa_), T);
}

CrossCheck::Two CrossCheck::known_leaks(double position_m, const EstimatorOutput& estimate) const noexcept {
  const Two p = join(estimate.chamber_pressure_Pa[0], estimate.chamber_pressure_Pa[1]), T = air_.temperature_K;
  const Two b(critical_ratio_);
  const Two other = join(estimate.chamber_pressure_Pa[1], estimate.chamber_pressure_Pa[0]);
  return orifice_mass_flow(air_, leak_area_, b, p, T, Two(atmosphere_Pa_), T) +
         orifice_mass_flow(air_, Two(piston_leak_m2_ + leak_zone_.area_at(position_m)), b, p, T, other, T);
}

std::uint64_t CrossCheck::check(const CrossCheckInput& in, const EstimatorOutput& estimate,
                                std::int64_t skipped) noexcept {
  watching_ = false;
  const bool whole = std::isfinite(in.port_Pa[0]) && std::isfinite(in.port_Pa[1]) && std::isfinite(in.supply_Pa);
  if (!whole || (estimate.health & estimator_not_started) != 0) {
    reset();
    return 0;
  }
  if (!started_) port_Pa_ = join(in.port_Pa[0], in.port_Pa[1]);
  started_ = true;
  const Two through_valve = valve_flow(in);
  if (skipped > 0) {  // what passed in skipped slots is not known: it is left out of the balance
    const Two fade(std::pow(decay_, static_cast<double>(skipped + 1)));
    missing_kg_ = fade * missing_kg_;
    through_kg_ = fade * through_kg_;
    // Nor did the estimator see it, which forgets that as it forgets a wrong start.
    ticks_ = std::max<std::int64_t>(0, ticks_ - rest_per_skipped * skipped);
    return 0;
  }
  if (ticks_ < settled_after_) {
    ++ticks_;
    return 0;
  }
  watching_ = true;
  const Two into_line = join(estimate.port_mass_flow_kgps[0], estimate.port_mass_flow_kgps[1]);
  const Two dt(period_s_), keep(decay_);
  missing_kg_ = keep * missing_kg_ + dt * (through_valve - into_line - known_leaks(in.position_m, estimate));
  through_kg_ = keep * through_kg_ + dt * Two(0.5) * (absolute(through_valve) + absolute(into_line));
  const Two measured = join(in.chamber_Pa[0], in.chamber_Pa[1]),
            estimated = join(estimate.chamber_pressure_Pa[0], estimate.chamber_pressure_Pa[1]);
  std::uint64_t faults = 0;
  for (int i = 0; i < 2; ++i) {
    const auto side = static_cast<std::size_t>(i);
    if (flow_limit_share_ > 0.0) {
      flow_share_[side] = std::fabs(missing_kg_[i]) / (flow_limit_share_ * through_kg_[i] + floor_kg_[i]);
      if (flow_share_[side] > 1.0) faults |= fault_flow_mismatch_1 << i;
    }
    if (chamber_limit_Pa_ > 0.0 && std::isfinite(measured[i])) {
      const double change = smoothing_ * (measured[i] - estimated[i] - difference_Pa_[i]);
      set_lane(difference_Pa_, i, difference_Pa_[i] + change);
      chamber_share_[side] = std::fabs(difference_Pa_[i]) / (chamber_limit_Pa_ + estimate.error_bound_Pa[i]);
      if (chamber_share_[side] > 1.0) faults |= fault_chamber_mismatch_1 << i;
    }
  }
  return faults;
}

}  // namespace pneuservo
