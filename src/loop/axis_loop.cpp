// The one pass of the control loop.
#include <pneuservo/loop/axis_loop.hpp>

#include <algorithm>
#include <cmath>

namespace pneuservo {
namespace {

double tolerance_of(const Rig& rig, const char* path) {
  const auto found = rig.tolerances.find(path);
  return found == rig.tolerances.end() ? 0.0 : found->second;
}

/// A sensor whose noise spans its quantum cannot repeat a value for long.
bool noise_shows(double noise, double quantum) { return noise > 0.0 && noise >= 0.5 * quantum; }

PlausibleChannel plausible_pressure(const Rig& rig, const PressureSensorParameters& sensor) {
  return {.lowest = 0.3 * rig.axis.air.atmosphere_Pa,
          .highest = 1.5 * rig.axis.supply.pressure_Pa,
          .noisy = noise_shows(sensor.noise_Pa, sensor.quantum_Pa)};
}

PlausibleChannel plausible_position(const Rig& rig) {
  const double reach =
      rig.axis.cylinder.stroke_m;  // twice the half stroke: beyond that the encoder is not of this axis
  const double noise = rig.sensors.position.noise_m, quantum = rig.sensors.position.quantum_m;
  return {.lowest = -reach,
          .highest = reach,
          .largest_step = rig.limits.speed_mps * rig.period_s + 6.0 * noise + quantum,
          // 50 mm/s does not end within a tick of 1 ms: that would take a deceleration of five times gravity.
          .frozen_step = 0.05 * rig.period_s + 6.0 * noise + quantum,
          .noisy = noise_shows(noise, quantum)};
}

}  // namespace

EstimatorParameters estimator_parameters(const Rig& rig) {
  EstimatorParameters p;
  p.air = rig.axis.air;
  p.supply_pressure_Pa = rig.axis.supply.pressure_Pa;
  p.line_1 = rig.axis.line_1;
  p.line_2 = rig.axis.line_2;
  p.cylinder = rig.axis.cylinder;
  p.period_s = rig.period_s;
  p.cells_per_m = rig.estimator.cells_per_m;
  p.valve = rig.axis.valve;
  p.flow_correction = rig.estimator.flow_correction;
  // Rounding to the quantum adds a variance of q^2/12.
  p.uncertainty.port_noise_Pa =
      std::hypot(rig.sensors.port_pressure.noise_Pa, rig.sensors.port_pressure.quantum_Pa / std::sqrt(12.0));
  p.uncertainty.relative_diameter =
      std::max(tolerance_of(rig, "line_1.diameter_m"), tolerance_of(rig, "line_2.diameter_m"));
  p.uncertainty.relative_area =
      std::max(tolerance_of(rig, "cylinder.area_1_m2"), tolerance_of(rig, "cylinder.area_2_m2"));
  p.uncertainty.relative_valve_area = tolerance_of(rig, "valve.area_per_volt_m2_per_V");
  return p;
}

void AxisLoop::configure(const Rig& rig, const LoadPositions& load) {
  period_s_ = rig.period_s;
  source_ = rig.controller.pressure_source;
  needs_chambers_ = source_ == PressureSource::chamber;
  safe_command_V_ = rig.safe_output.command_V;
  speed_limit_mps_ = rig.limits.speed_mps;
  reach_m_ = 0.5 * rig.axis.cylinder.stroke_m + rig.limits.position_margin_m;
  estimator_.configure(estimator_parameters(rig));
  controller_.configure(rig.controller, rig.axis, rig.period_s);
  reference_ = Reference(rig.reference, load);
  position_guard_.configure(plausible_position(rig));
  for (auto& guard : port_guard_) guard.configure(plausible_pressure(rig, rig.sensors.port_pressure));
  for (auto& guard : chamber_guard_) guard.configure(plausible_pressure(rig, rig.sensors.chamber_pressure));
  rearm();
}

void AxisLoop::rearm() noexcept {
  faults_ = first_faults_ = 0;
  begins_ = true;
  stopped_ = limited_ = false;
  command_V_ = velocity_mps_ = 0.0;
  estimator_.reset();
  controller_.reset();
  position_guard_.reset();
  for (auto& guard : port_guard_) guard.reset();
  for (auto& guard : chamber_guard_) guard.reset();
}

void AxisLoop::latch(std::uint32_t faults) noexcept {
  if (faults_ == 0) first_faults_ = faults;
  faults_ |= faults;
}

AxisLoop::Inputs AxisLoop::guard(const Measurement& measured) noexcept {
  Inputs in{};
  std::uint32_t faults = 0;
  in.position_m = position_guard_.check(measured.position_m);
  if (position_guard_.missing) faults |= fault_position_missing;
  if (position_guard_.jumped) faults |= fault_position_jump;
  if (position_guard_.frozen) faults |= fault_position_frozen;
  if (std::fabs(in.position_m) > reach_m_) faults |= fault_position_range;
  in.port_1_Pa = port_guard_[0].check(measured.port_pressure_1_Pa);
  in.port_2_Pa = port_guard_[1].check(measured.port_pressure_2_Pa);
  if (port_guard_[0].missing) faults |= fault_port_pressure_1_missing;
  if (port_guard_[1].missing) faults |= fault_port_pressure_2_missing;
  if (port_guard_[0].frozen) faults |= fault_port_pressure_1_frozen;
  if (port_guard_[1].frozen) faults |= fault_port_pressure_2_frozen;
  if (needs_chambers_) {
    in.chamber_1_Pa = chamber_guard_[0].check(measured.chamber_pressure_1_Pa);
    in.chamber_2_Pa = chamber_guard_[1].check(measured.chamber_pressure_2_Pa);
    if (chamber_guard_[0].missing) faults |= fault_chamber_pressure_1_missing;
    if (chamber_guard_[1].missing) faults |= fault_chamber_pressure_2_missing;
    if (chamber_guard_[0].frozen) faults |= fault_chamber_pressure_1_frozen;
    if (chamber_guard_[1].frozen) faults |= fault_chamber_pressure_2_frozen;
  }
  if (faults != 0) latch(faults);
  return in;
}

// From here to the reference's first value, at rest at both ends, then the reference's own time begins.
void AxisLoop::plan_motion(double t_s, double position_m) noexcept {
  begins_ = false;
  approach_start_s_ = t_s;
  approach_from_m_ = position_m;
  approach_to_m_ = reference_.at(0.0).d[0];
  const double way = std::fabs(approach_to_m_ - approach_from_m_);
  // 1.875: peak over mean speed of a minimum-jerk move.
  const double duration =
      way <= approach_tolerance_m ? 0.0 : std::max(approach_shortest_s, 1.875 * way / approach_speed_mps);
  reference_start_s_ = t_s + period_s_ * std::ceil(duration / period_s_);
}

ReferencePoint AxisLoop::reference_at(double t_s) const noexcept {
  if (t_s >= reference_start_s_) return reference_.at(t_s - reference_start_s_);
  const double duration = reference_start_s_ - approach_start_s_, way = approach_to_m_ - approach_from_m_;
  const double z = std::clamp((t_s - approach_start_s_) / duration, 0.0, 1.0);
  ReferencePoint point;
  point.d[0] = approach_from_m_ + way * z * z * z * (10.0 + z * (-15.0 + 6.0 * z));
  point.d[1] = way / duration * z * z * (30.0 + z * (-60.0 + 30.0 * z));
  point.d[2] = way / (duration * duration) * z * (60.0 + z * (-180.0 + 120.0 * z));
  point.d[3] = way / (duration * duration * duration) * (60.0 + z * (-360.0 + 360.0 * z));
  return point;
}

std::array<double, 2> AxisLoop::pressures(const Inputs& inputs, const EstimatorOutput& estimate) const noexcept {
  switch (source_) {
    case PressureSource::valve: return {inputs.port_1_Pa, inputs.port_2_Pa};
    case PressureSource::chamber: return {inputs.chamber_1_Pa, inputs.chamber_2_Pa};
    case PressureSource::estimated: break;
  }
  return {estimate.chamber_pressure_Pa[0], estimate.chamber_pressure_Pa[1]};
}

double AxisLoop::control(double t_s, const Inputs& inputs, const EstimatorOutput& estimate) noexcept {
  if (begins_) plan_motion(t_s, inputs.position_m);
  now_ = reference_at(t_s);
  const double lead_s = controller_.lead_s();
  const ReferencePoint ahead = lead_s > 0.0 ? reference_at(t_s + lead_s) : now_;
  const auto p = pressures(inputs, estimate);
  const double command = controller_.step(inputs.position_m, p[0], p[1], now_, ahead);
  const PdForceState& state = controller_.state();
  velocity_mps_ = state.v_mps;
  limited_ = state.limit != limit_none;
  std::uint32_t faults = 0;
  if (state.fault != controller_healthy) faults |= fault_command_not_finite;
  if (std::fabs(velocity_mps_) > speed_limit_mps_) faults |= fault_speed;
  if (source_ == PressureSource::estimated && !(estimate.valid[0] && estimate.valid[1]))
    faults |= fault_estimate_invalid;
  if (faults != 0) latch(faults);
  return command;
}

bool AxisLoop::pass(Backend& backend, std::int64_t tick, std::int64_t skipped, StageTimes* times,
                    std::int64_t (*now)() noexcept) noexcept {
  const auto stamp = [&](std::int64_t StageTimes::* stage) {
    if (times != nullptr) times->*stage = now();
  };
  const double t_s = static_cast<double>(tick) * period_s_;
  stamp(&StageTimes::start);
  Measurement measured;
  if (!backend.read(tick, measured)) return false;
  const Truth truth = backend.truth();  // for the row alone, taken at the sampling instant
  stamp(&StageTimes::read);
  const Inputs inputs = guard(measured);
  // Skipped slots passed without a sample: the model goes through them with the newest one.
  for (std::int64_t i = 0; i < std::min<std::int64_t>(skipped, 10); ++i)
    estimator_.step({inputs.port_1_Pa, inputs.port_2_Pa, inputs.position_m, velocity_mps_, command_V_});
  const EstimatorOutput estimate =
      estimator_.step({inputs.port_1_Pa, inputs.port_2_Pa, inputs.position_m, velocity_mps_, command_V_});
  stamp(&StageTimes::estimated);
  if (faults_ == 0 && !stopped_) command_V_ = control(t_s, inputs, estimate);
  if (faults_ != 0 || stopped_) {
    command_V_ = safe_command_V_;
    limited_ = false;
  }
  stamp(&StageTimes::controlled);
  if (!backend.write(tick, {command_V_})) latch(fault_output_missed);
  stamp(&StageTimes::written);
  fill_row(t_s, skipped, measured, truth, estimate, command_V_);
  return true;
}

void AxisLoop::stop(Backend& backend, std::int64_t tick) noexcept {
  stopped_ = true;
  command_V_ = safe_command_V_;
  backend.write(tick, {command_V_});
}

void AxisLoop::fill_row(double t_s, std::int64_t skipped, const Measurement& measured, const Truth& truth,
                        const EstimatorOutput& estimate, double command_V) noexcept {
  const auto recorded = [](const Channel& channel) {
    return channel.origin == Origin::absent ? Row::none : channel.value;
  };
  row_ = Row{};
  row_.t_s = t_s;
  row_.x_ref_m = now_.d[0];
  row_.v_ref_mps = now_.d[1];
  row_.x_m = recorded(measured.position_m);
  row_.v_mps = velocity_mps_;
  row_.u_V = command_V;
  row_.p1_port_Pa = recorded(measured.port_pressure_1_Pa);
  row_.p2_port_Pa = recorded(measured.port_pressure_2_Pa);
  row_.p1_chamber_Pa = recorded(measured.chamber_pressure_1_Pa);
  row_.p2_chamber_Pa = recorded(measured.chamber_pressure_2_Pa);
  row_.p1_estimated_Pa = estimate.chamber_pressure_Pa[0];
  row_.p2_estimated_Pa = estimate.chamber_pressure_Pa[1];
  row_.p1_bound_Pa = estimate.error_bound_Pa[0];
  row_.p2_bound_Pa = estimate.error_bound_Pa[1];
  row_.mass_flow_1_kgps = estimate.mass_flow_kgps[0];
  row_.mass_flow_2_kgps = estimate.mass_flow_kgps[1];
  row_.p_supply_Pa = recorded(measured.supply_pressure_Pa);
  row_.x_true_m = truth.position_m;
  row_.p1_chamber_true_Pa = truth.chamber_pressure_1_Pa;
  row_.p2_chamber_true_Pa = truth.chamber_pressure_2_Pa;
  row_.flags =
      (skipped > 0 ? row_overrun : 0u) | (limited_ ? row_command_limited : 0u) | (faults_ != 0 ? row_fault : 0u);
  row_.fault = faults_;
}

}  // namespace pneuservo
