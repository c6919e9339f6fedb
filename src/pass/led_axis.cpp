// The led axis: one run, and its answer to a pulse.
#include "pass/led_axis.hpp"

#include <algorithm>
#include <cmath>

#include <pneuservo/control/flow_feedforward.hpp>

namespace pneuservo {
namespace {

/// Rest before, motion after what is used: the longest cut-off period of the learning some six times.
constexpr double after_s = 0.5;

std::size_t periods_in(double time_s, double period_s) {
  return static_cast<std::size_t>(std::llround(time_s / period_s));
}

}  // namespace

PassMotion::PassMotion(const Rig& rig, const Reference& reference, const MotionScale& scale)
    : reference_(reference), scale_(scale), period_s_(rig.period_s),
      first_(periods_in(PassTable::rest_s, rig.period_s)),
      used_(periods_in(rig.duration_s / scale.speed, rig.period_s) + 1), after_(periods_in(after_s, rig.period_s)) {}

ReferencePoint PassMotion::at(std::size_t tick) const noexcept {
  const double t_s = (static_cast<double>(tick) - static_cast<double>(first_)) * period_s_;
  ReferencePoint point = reference_.at(t_s * scale_.speed);
  const double from_m = reference_.at(0.0).d[0];
  point.d[0] = from_m + scale_.size * (point.d[0] - from_m);
  double factor = scale_.size;
  for (std::size_t i = 1; i < point.d.size(); ++i) point.d[i] *= factor *= scale_.speed;
  return point;
}

LedAxis::LedAxis(const Rig& rig, double force_feedback_V_per_N)
    : rig_(rig), feedback_V_per_N_(force_feedback_V_per_N), compensation_(rig.axis.effects.valve) {
  plant_.configure(rig.axis, rig.period_s, cells_per_m, valve_arrangement(rig));
}

double LedAxis::limited_V(double command_V) const noexcept {
  return std::clamp(command_V, -rig_.axis.valve.command_max_V, rig_.axis.valve.command_max_V);
}

// Chambers that hold the load at rest there, where the config does not state the second one.
void LedAxis::start(AxisPlant<double>& plant, double position_m) const noexcept {
  const CylinderParameters<double>& cylinder = rig_.axis.cylinder;
  double p_1 = rig_.initial.pressure_1_Pa,
         p_2 = rig_.initial.pressure_2_Pa.value_or(balancing_pressure_2(rig_.axis, p_1));
  if (!rig_.initial.pressure_2_Pa) {
    const double held_N = plant.slider().driving_force_for(position_m, 0.0, 0.0, {}, turning_mps);
    const double balanced_Pa = p_2 - held_N / cylinder.area_2_m2;
    p_2 = std::clamp(balanced_Pa, rig_.axis.air.atmosphere_Pa, rig_.axis.supply.pressure_Pa);
    p_1 += (p_2 - balanced_Pa) * cylinder.area_2_m2 / cylinder.area_1_m2;
  }
  plant.reset({position_m, p_1, p_2});
}

const std::vector<LedTick>& LedAxis::run(const PassMotion& motion, const std::vector<double>& asked_V) {
  const double atmosphere_Pa = rig_.axis.air.atmosphere_Pa;
  const ElasticFriction<double>& elastic = rig_.axis.effects.motion.elastic_friction;
  const FlowFeedforward formula(rig_.axis);
  ticks_.resize(motion.ticks());
  ReferencePoint now = motion.at(0);
  start(plant_, now.d[0]);
  double bristles_N = 0.0;
  DeadBandAndPlayCompensation::State compensated = compensation_.at(0.0);
  for (std::size_t i = 0; i < ticks_.size(); ++i) {
    LedTick& tick = ticks_[i];
    tick.values = true_values(plant_);
    tick.force_N = plant_.driving_force();
    const double p_1 = tick.values[Signal::p1_chamber], p_2 = tick.values[Signal::p2_chamber];
    const double gauge_Pa = std::max(p_1 - atmosphere_Pa, 0.0) + std::max(p_2 - atmosphere_Pa, 0.0);
    tick.wanted_N =
        bristles_N + plant_.slider().driving_force_for(now.d[0], now.d[1], now.d[2], {gauge_Pa}, turning_mps);
    const double known_V =
        asked_V.empty() ? formula.command_V(now, p_1, p_2, tick.values[Signal::p_supply]) : asked_V[i];
    compensated =
        compensation_.next(compensated, limited_V(known_V + feedback_V_per_N_ * (tick.wanted_N - tick.force_N)));
    tick.asked_V = compensated.asked_V;
    tick.u_V = limited_V(compensation_.command_V(compensated));
    const ReferencePoint next = motion.at(i + 1);
    bristles_N = elastic.carried(bristles_N, next.d[0] - now.d[0]);
    now = next;
    plant_.step_led(tick.u_V, -tick.u_V, now.d[0]);
  }
  return ticks_;
}

AxisParameters<double> smooth_axis(AxisParameters<double> axis) {
  auto& valve = axis.effects.valve;
  valve.valve_dead_band = {}, valve.valve_hysteresis = {}, valve.valve_stiction = {};
  auto& motion = axis.effects.motion;
  motion.coulomb_friction = {}, motion.stribeck_friction = {}, motion.direction_dependent_friction = {};
  motion.pressure_dependent_friction = {}, motion.friction_zone = {}, motion.elastic_friction = {};
  return axis;
}

std::vector<double> LedAxis::pulse_response(double pulse_V, std::size_t ticks) {
  AxisParameters<double> smooth = smooth_axis(rig_.axis);
  smooth.effects.valve.valve_offset = {};  // it starts with a command of 0
  AxisPlant<double> plant;
  plant.configure(smooth, rig_.period_s, cells_per_m, valve_arrangement(rig_));
  std::vector<double> response(ticks);
  for (const double added_V : {0.0, pulse_V}) {
    start(plant, 0.0);
    const double rest_N = plant.driving_force();
    for (std::size_t i = 0; i < ticks; ++i) {
      const double force_N = plant.driving_force();
      response[i] = force_N - (added_V > 0.0 ? response[i] : 0.0);
      const double u_V = limited_V((i == 0 ? added_V : 0.0) - feedback_V_per_N_ * (force_N - rest_N));
      plant.step_led(u_V, -u_V, 0.0);
    }
  }
  for (double& value : response) value /= pulse_V;
  return response;
}

}  // namespace pneuservo
