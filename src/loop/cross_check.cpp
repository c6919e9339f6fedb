// Cross-checks of the sensors against the model.
#include <pneuservo/loop/cross_check.hpp>

#include <algorithm>
#include <cmath>

#include <pneuservo/loop/fault.hpp>

namespace pneuservo {
namespace {

using Two = Pack<double, 2>;

/// The faults of the sides where `found` is above `limit`.
std::uint64_t exceeded(const Two& found, const Two& limit, const std::array<Fault, 2>& fault) noexcept {
  std::uint64_t faults = 0;
  if (low(found) > low(limit)) faults |= fault[0];
  if (high(found) > high(limit)) faults |= fault[1];
  return faults;
}

/// Air of one side, line and chamber at mid-stroke, at supply pressure [kg].
double full_air_kg(const Rig& rig, const LineParameters<double>& line, double area_m2, double dead_volume_m3) {
  const double volume_m3 = line.volume_m3() + dead_volume_m3 + 0.5 * area_m2 * rig.axis.cylinder.stroke_m;
  const auto& air = rig.axis.air;
  return rig.axis.supply.pressure_Pa * volume_m3 / (air.gas_constant_J_per_kgK * air.temperature_K);
}

}  // namespace

void CrossCheck::configure(const Rig& rig) {
  const auto& axis = rig.axis;
  valves_.configure(axis.air, valve_arrangement(rig), axis.valve, axis.effects.valve, rig.period_s);
  period_s_ = rig.period_s;
  flow_limit_share_ = rig.limits.flow_mismatch_share;
  chamber_limit_Pa_ = rig.limits.chamber_mismatch_Pa;
  const auto& c = axis.cylinder;
  floor_kg_ = join(floor_share * full_air_kg(rig, axis.line_1, c.area_1_m2, c.dead_volume_1_m3),
                   floor_share * full_air_kg(rig, axis.line_2, c.area_2_m2, c.dead_volume_2_m3));
  decay_ = std::exp(-rig.period_s / window_s);
  smoothing_ = -std::expm1(-rig.period_s / smoothing_s);
  settled_after_ = std::llround(settle_s / rig.period_s);
  reset();
}

void CrossCheck::reset() noexcept {
  valves_.reset();
  missing_kg_ = through_kg_ = difference_Pa_ = Two(0);
  ticks_ = 0;
  watching_ = false;
  air_limit_kg_ = difference_limit_Pa_ = Two(1);
}

std::uint64_t CrossCheck::check(const CrossCheckInput& in, const EstimatorOutput& estimate,
                                std::int64_t skipped) noexcept {
  watching_ = false;
  const bool whole = std::isfinite(in.port_Pa[0]) && std::isfinite(in.port_Pa[1]) && std::isfinite(in.supply_Pa);
  if (!whole || (estimate.health & estimator_not_started) != 0) {
    reset();
    return 0;
  }
  const Two through_valve = valves_.step(in.command_V, in.port_Pa, in.supply_Pa);
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
  missing_kg_ = keep * missing_kg_ + dt * (through_valve - into_line);
  through_kg_ = keep * through_kg_ + dt * Two(0.5) * (absolute(through_valve) + absolute(into_line));
  return judge_air() | judge_chambers(join(in.chamber_Pa[0], in.chamber_Pa[1]), estimate);
}

std::uint64_t CrossCheck::judge_air() noexcept {
  if (!(flow_limit_share_ > 0.0)) return 0;
  air_limit_kg_ = Two(flow_limit_share_) * through_kg_ + floor_kg_;
  return exceeded(absolute(missing_kg_), air_limit_kg_, {fault_flow_mismatch_1, fault_flow_mismatch_2});
}

std::uint64_t CrossCheck::judge_chambers(const Two& measured_Pa, const EstimatorOutput& estimate) noexcept {
  if (!(chamber_limit_Pa_ > 0.0)) return 0;
  const Two estimated = join(estimate.chamber_pressure_Pa[0], estimate.chamber_pressure_Pa[1]),
            bound = join(estimate.error_bound_Pa[0], estimate.error_bound_Pa[1]);
  const Two change = Two(smoothing_) * (measured_Pa - estimated - difference_Pa_);
  difference_Pa_ += select(measured_Pa == measured_Pa, change, Two(0));  // without a sensor it is NaN
  difference_limit_Pa_ = Two(chamber_limit_Pa_) + bound;
  return exceeded(absolute(difference_Pa_), difference_limit_Pa_, {fault_chamber_mismatch_1, fault_chamber_mismatch_2});
}

}  // namespace pneuservo
