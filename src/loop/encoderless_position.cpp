// The loop's position where there is no encoder.
#include <pneuservo/loop/encoderless_position.hpp>

#include <algorithm>
#include <cmath>

#include <pneuservo/control/line_mode.hpp>

#include "loop/motion_limits.hpp"

namespace pneuservo {
namespace {

/// The observer looks back no further than this: more slots that passed unseen are a position that is not known.
constexpr std::int64_t most_unseen_slots = 10;

double stated(const Rig& rig, const char* path) {
  const auto found = rig.tolerances.find(path);
  return found == rig.tolerances.end() ? 0.0 : found->second;
}
double larger(const Rig& rig, const char* one, const char* other) {
  return std::max(stated(rig, one), stated(rig, other));
}

}  // namespace

PositionObserverParameters position_observer_parameters(const Rig& rig) {
  const auto& axis = rig.axis;
  const auto& c = axis.cylinder;
  const Air<double> air(axis.air);
  PositionObserverParameters p;
  p.period_s = rig.period_s;
  p.stroke_m = c.stroke_m;
  p.area_m2 = {c.area_1_m2, c.area_2_m2};
  p.dead_volume_m3 = {c.dead_volume_1_m3, c.dead_volume_2_m3};
  p.line_volume_m3 = {axis.line_1.volume_m3(), axis.line_2.volume_m3()};
  p.gas_constant_J_per_kgK = axis.air.gas_constant_J_per_kgK;
  p.atmosphere_Pa = axis.air.atmosphere_Pa;
  p.mass_kg = axis.slider.mass_kg + axis.slider.payload_kg;
  p.viscous_friction_Ns_per_m = axis.slider.viscous_friction_Ns_per_m;
  p.travel_s = std::max(axis.line_1.length_m, axis.line_2.length_m) / air.sound_speed();
  const auto mode_Hz = [&](const LineParameters<double>& line, double area_m2, double dead_volume_m3) {
    return first_line_mode(line, dead_volume_m3 + 0.5 * area_m2 * c.stroke_m, air.R * air.temperature_K).frequency_Hz;
  };
  p.mode_s = 1.0 / std::min(mode_Hz(axis.line_1, c.area_1_m2, c.dead_volume_1_m3),
                            mode_Hz(axis.line_2, c.area_2_m2, c.dead_volume_2_m3));
  p.mass_share = stated(rig, "slider.mass_kg");
  p.viscous_share = stated(rig, "slider.viscous_friction_Ns_per_m");
  p.unknown_force_N = rig.position.unknown_force_N.value_or(0.5 * dry_friction_max_N(rig));
  p.valve_area_share = stated(rig, "valve.area_per_volt_m2_per_V");
  // Near choked flow an orifice gives by a fifth of what its critical ratio is wrong by.
  p.valve_edge_share =
      std::hypot(0.2 * stated(rig, "valve.critical_pressure_ratio"), stated(rig, "supply.pressure_Pa"));
  const double section_share = 2.0 * larger(rig, "line_1.diameter_m", "line_2.diameter_m");
  p.volume_share = std::hypot(section_share, larger(rig, "line_1.length_m", "line_2.length_m"));
  p.wall_heat_share = stated(rig, "cylinder.wall_heat_W_per_m2K");
  p.leak_kgps = rig.position.leak_kgps;
  p.switch_m = rig.position.repeatability_m;
  return p;
}

void EncoderlessPosition::configure(const Rig& rig) {
  is_on_ = rig.position.is_estimated();
  if (!is_on_) return;
  parameters_ = rig.position;
  bound_max_m_ = rig.position.bound_max_m;
  blend_ = std::exp(-rig.period_s / blend_s);
  return_ = std::exp(-rig.period_s / return_s);
  settled_after_ = std::llround(settle_s / rig.period_s);
  observer_.configure(position_observer_parameters(rig));
  const auto& axis = rig.axis;
  valves_.configure(axis.air, valve_arrangement(rig), axis.valve, axis.effects.valve, rig.period_s);
  reset();
}

void EncoderlessPosition::reset() noexcept {
  if (!is_on_) return;
  observer_.reset(parameters_.start_m, parameters_.start_deviation_m);
  valves_.reset();
  low_ = high_ = LineState::absent;
  withheld_m_ = 0.0;
  doubt_m_ = observer_.bound_m();
  ticks_ = 0;
  lost_ = false;
}

void EncoderlessPosition::step(const std::array<double, 2>& command_V, const std::array<double, 2>& port_Pa,
                               double supply_Pa, const EstimatorOutput& estimate, std::int64_t skipped) noexcept {
  if (!(std::isfinite(port_Pa[0]) && std::isfinite(port_Pa[1])) || (estimate.health & estimator_not_started) != 0)
    return;
  const Pack<double, 2> flow = valves_.step(command_V, port_Pa, supply_Pa);
  ticks_ += skipped + 1;
  if (!is_settled()) return;
  lost_ = lost_ || skipped > most_unseen_slots;
  const PositionObserverInput in{.valve_flow_kgps = {low(flow), high(flow)},
                                 .line_flow_kgps = {estimate.port_mass_flow_kgps[0], estimate.port_mass_flow_kgps[1]},
                                 .chamber_Pa = {estimate.chamber_pressure_Pa[0], estimate.chamber_pressure_Pa[1]},
                                 .chamber_K = {estimate.chamber_temperature_K[0], estimate.chamber_temperature_K[1]},
                                 .chamber_bound_Pa = {estimate.error_bound_Pa[0], estimate.error_bound_Pa[1]}};
  observer_.step(in);
  withheld_m_ *= blend_;
  doubt_m_ = std::max(observer_.bound_m(), return_ * doubt_m_);
}

// A line that cannot be read says nothing any more: the position would be lost sooner or later without a word.
void EncoderlessPosition::see(const DigitalInputs& digital) noexcept {
  lost_ =
      lost_ || digital.switch_low.state == LineState::unreadable || digital.switch_high.state == LineState::unreadable;
  const double back_m = parameters_.hysteresis_m;
  pass(digital.switch_low, low_, parameters_.low_m, parameters_.low_m + back_m);
  pass(digital.switch_high, high_, parameters_.high_m, parameters_.high_m - back_m);
}

void EncoderlessPosition::pass(const DigitalLine& line, LineState& last, double on_m, double off_m) noexcept {
  const bool changed = is_settled() && last != LineState::absent && line.state != last;
  last = line.state;
  if (!changed || (line.state != LineState::on && line.state != LineState::off)) return;
  const double before_m = observer_.position_m();
  observer_.pass(line.state == LineState::on ? on_m : off_m);
  withheld_m_ += observer_.position_m() - before_m;
}

}  // namespace pneuservo
