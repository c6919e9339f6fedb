// The one pass of the control loop.
#include <pneuservo/loop/axis_loop.hpp>

#include <algorithm>
#include <cmath>

#include <pneuservo/control/smoothstep.hpp>

namespace pneuservo {
namespace {

double tolerance_of(const Rig& rig, const char* path) {
  const auto found = rig.tolerances.find(path);
  return found == rig.tolerances.end() ? 0.0 : found->second;
}

/// Steps of 5 % of the supply in a period are beyond what lines and chambers do with a calm valve; what an active one
/// and small volumes add is told tick by tick.
PlausibleChannel plausible_pressure(const Rig& rig, const PressureSensorParameters& sensor, int start_ticks) {
  return {.lowest = 0.3 * rig.axis.air.atmosphere_Pa,
          .highest = 1.5 * rig.axis.supply.pressure_Pa,
          .slack = 6.0 * sensor.noise_Pa + sensor.quantum_Pa,
          .step_per_period = 0.05 * rig.axis.supply.pressure_Pa,
          .frozen_ticks = frozen_after_ticks(sensor.noise_Pa, sensor.quantum_Pa),
          .start_ticks = start_ticks};
}

/// Full supply on the larger piston area, nothing on the other side.
double fastest_start_mps2(const Rig& rig) {
  const auto& cylinder = rig.axis.cylinder;
  return rig.axis.supply.pressure_Pa * std::max(cylinder.area_1_m2, cylinder.area_2_m2) /
         (rig.axis.slider.mass_kg + rig.axis.slider.payload_kg);
}

PlausibleChannel plausible_position(const Rig& rig, int start_ticks) {
  const double noise = rig.sensors.position.noise_m, quantum = rig.sensors.position.quantum_m;
  const double reach = rig.axis.cylinder.stroke_m;  // twice the half: beyond that the encoder is not of this axis
  // To lose 0.1 m/s, or 100 m/s2 where a period is long, from one sample to the next and then rest takes a blow.
  const double stopping_mps = std::max(0.1, 100.0 * rig.period_s);
  return {.lowest = -reach,
          .highest = reach,
          .slack = 6.0 * noise + quantum,
          .step_per_period = 2.0 * rig.limits.speed_mps * rig.period_s,  // below that the fault is `speed`
          .step_growth = 3.0 * fastest_start_mps2(rig) * rig.period_s * rig.period_s,
          .stopping_step = stopping_mps * rig.period_s + 6.0 * noise + quantum,
          .frozen_ticks = frozen_after_ticks(noise, quantum),
          .start_ticks = start_ticks};
}

/// Choked flow of the fully opened area into the line, per volt [kg/(s V)].
double largest_flow_per_volt(const Rig& rig) {
  const auto& air = rig.axis.air;
  return 0.685 * rig.axis.supply.pressure_Pa / std::sqrt(air.gas_constant_J_per_kgK * air.temperature_K) *
         rig.axis.valve.area_per_volt_m2_per_V;
}

/// A change of flow dG sends a wave of c dG / A into a line: what a volt does to the pressure at its port at once.
double port_step_Pa_per_V(const Rig& rig) {
  const auto& air = rig.axis.air;
  const double diameter = std::min(rig.axis.line_1.diameter_m, rig.axis.line_2.diameter_m);
  const double sound_mps = std::sqrt(air.heat_capacity_ratio * air.gas_constant_J_per_kgK * air.temperature_K);
  return sound_mps * largest_flow_per_volt(rig) / (0.25 * 3.141592653589793 * diameter * diameter);
}

constexpr double margin = 2.0;                 // over both estimates of steps: waves add up
constexpr double activity_time_s = 0.2;        // echoes of a change of command die out
constexpr double first_value_within_s = 0.1;
constexpr double at_end_stop_m = 1e-3;
constexpr std::size_t approach_degree = 9;
constexpr std::int64_t most_caught_up_steps = 10;  // a late tick must not grow long itself

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
  rig_ = rig.kind;
  safe_V_.fill(rig.safe_output.command_V);
  speed_limit_mps_ = rig.limits.speed_mps;
  cylinder_ = rig.axis.cylinder;
  half_stroke_m_ = 0.5 * rig.axis.cylinder.stroke_m;
  position_margin_m_ = rig.limits.position_margin_m;
  port_step_Pa_per_V_ = margin * port_step_Pa_per_V(rig);
  const auto& air = rig.axis.air;
  fill_step_Pa_m3_ = margin * air.heat_capacity_ratio * air.gas_constant_J_per_kgK * air.temperature_K *
                     largest_flow_per_volt(rig) * rig.axis.valve.command_max_V * rig.period_s;
  activity_decay_ = std::exp(-rig.period_s / activity_time_s);
  estimator_.configure(estimator_parameters(rig));
  reference_ = Reference(rig.reference, load);
  controller_.configure(rig.controller, rig.axis, rig.period_s, reference_, rig.duration_s);
  source_ = controller_.pressure_source();
  needs_chambers_ = source_ == PressureSource::chamber;
  tolerance_m_ =
      std::min(approach_tolerance_m, approach_quanta * (rig.sensors.position.quantum_m + rig.sensors.position.noise_m));
  const int start_ticks = std::max(3, static_cast<int>(std::lround(first_value_within_s / rig.period_s)));
  position_guard_.configure(plausible_position(rig, start_ticks));
  for (auto& guard : port_guard_) guard.configure(plausible_pressure(rig, rig.sensors.port_pressure, start_ticks));
  for (auto& guard : chamber_guard_)
    guard.configure(plausible_pressure(rig, rig.sensors.chamber_pressure, start_ticks));
  command_V_ = safe_V_;
  rearm();
}

void AxisLoop::rearm() noexcept {
  faults_ = first_faults_ = 0;
  begins_ = true;
  moved_ = stopped_ = limited_ = false;
  velocity_mps_ = 0.0;
  estimator_.reset();
  controller_.reset(command_V_);
  position_guard_.reset();
  for (auto& guard : port_guard_) guard.reset();
  for (auto& guard : chamber_guard_) guard.reset();
}

void AxisLoop::latch(std::uint64_t faults) noexcept {
  if (faults_ == 0) first_faults_ = faults;
  faults_ |= faults;
}

std::uint64_t AxisLoop::check_position(const Channel& position, double periods, Inputs& in) noexcept {
  std::uint64_t faults = 0;
  const bool at_end_stop = std::fabs(position.value) > half_stroke_m_ - at_end_stop_m;
  in.position_m = position_guard_.check(position, periods, 0.0, at_end_stop);
  if (position_guard_.missing) faults |= fault_position_missing;
  if (position_guard_.jumped) faults |= fault_position_jump;
  if (position_guard_.frozen) faults |= fault_position_frozen;
  if (std::fabs(in.position_m) > half_stroke_m_ + position_margin_m_) faults |= fault_position_range;
  return faults;
}

double AxisLoop::chamber_step_Pa(double dead_volume_m3, double area_m2, double way_m) const noexcept {
  return fill_step_Pa_m3_ / (dead_volume_m3 + area_m2 * std::max(way_m, 0.0));
}

std::uint64_t AxisLoop::check_pressures(const Measurement& measured, double periods, Inputs& in) noexcept {
  std::uint64_t faults = 0;
  const auto judge = [&](InputGuard& guard, const Channel& channel, double extra_Pa, std::uint64_t missing,
                         std::uint64_t frozen, std::uint64_t jump) noexcept {
    const double value = guard.check(channel, periods, extra_Pa);
    faults |= (guard.missing ? missing : 0) | (guard.frozen ? frozen : 0) | (guard.jumped ? jump : 0);
    return value;
  };
  const double wave_Pa = port_step_Pa_per_V_ * activity_V_;
  in.port_1_Pa = judge(port_guard_[0], measured.port_pressure_1_Pa, wave_Pa, fault_port_pressure_1_missing,
                       fault_port_pressure_1_frozen, fault_port_pressure_1_jump);
  in.port_2_Pa = judge(port_guard_[1], measured.port_pressure_2_Pa, wave_Pa, fault_port_pressure_2_missing,
                       fault_port_pressure_2_frozen, fault_port_pressure_2_jump);
  if (!needs_chambers_) return faults;
  const double x = std::isfinite(in.position_m) ? in.position_m : 0.0;
  in.chamber_1_Pa =
      judge(chamber_guard_[0], measured.chamber_pressure_1_Pa,
            chamber_step_Pa(cylinder_.dead_volume_1_m3, cylinder_.area_1_m2, half_stroke_m_ + x),
            fault_chamber_pressure_1_missing, fault_chamber_pressure_1_frozen, fault_chamber_pressure_1_jump);
  in.chamber_2_Pa =
      judge(chamber_guard_[1], measured.chamber_pressure_2_Pa,
            chamber_step_Pa(cylinder_.dead_volume_2_m3, cylinder_.area_2_m2, half_stroke_m_ - x),
            fault_chamber_pressure_2_missing, fault_chamber_pressure_2_frozen, fault_chamber_pressure_2_jump);
  return faults;
}

AxisLoop::Inputs AxisLoop::guard(const Measurement& measured, std::int64_t skipped) noexcept {
  Inputs in{};
  const double periods = static_cast<double>(skipped + 1);
  std::uint64_t faults = check_position(measured.position_m, periods, in);
  faults |= check_pressures(measured, periods, in);
  faults |= std::uint64_t{measured.device_faults} << device_fault_shift & device_fault_mask;
  faults |= check_digital(measured.digital);
  if (faults != 0) latch(faults);
  return in;
}

// A line that cannot be read counts as the worse of its states. A limit switch ends the motion when the slider comes
// onto it, not while it stands there: otherwise no motion could lead off it.
std::uint64_t AxisLoop::check_digital(const DigitalInputs& digital) noexcept {
  std::uint64_t faults = 0;
  const auto bad = [](const DigitalLine& line, LineState state) noexcept {
    return line.state == state || line.state == LineState::unreadable;
  };
  if (bad(digital.emergency_stop, LineState::on)) faults |= fault_emergency_stop;
  if (bad(digital.valve_power, LineState::off)) faults |= fault_valve_power;
  const std::array<LineState, 2> limits{digital.limit_low.state, digital.limit_high.state};
  for (std::size_t i = 0; i < limits.size(); ++i)
    if (limits[i] == LineState::unreadable || (limits[i] == LineState::on && limits_[i] == LineState::off))
      faults |= fault_limit_switch;
  limits_ = limits;
  return faults;
}

bool AxisLoop::waiting() const noexcept {
  return position_guard_.waiting() || port_guard_[0].waiting() || port_guard_[1].waiting() ||
         (needs_chambers_ && (chamber_guard_[0].waiting() || chamber_guard_[1].waiting()));
}

std::uint64_t AxisLoop::check_standstill() noexcept {
  if (position_guard_.equal_ticks() == 0) standstill_reference_m_ = now_.d[0];
  const bool long_enough = position_guard_.equal_ticks() * period_s_ >= standstill_s;
  const double way = std::fabs(now_.d[0] - standstill_reference_m_);
  return long_enough && way > 2.0 * half_stroke_m_ * standstill_share ? fault_position_frozen : 0;
}

// How much the commands have moved of late, from one tick to the next.
void AxisLoop::note_commands(const std::array<double, 2>& command_V) noexcept {
  const double step_V = std::max(std::fabs(command_V[0] - command_V_[0]), std::fabs(command_V[1] - command_V_[1]));
  activity_V_ = std::max(step_V, activity_V_ * activity_decay_);
  command_V_ = command_V;
}

// From here to the reference's first value, at rest at both ends, a rest there, then the reference's own time begins.
void AxisLoop::plan_motion(double t_s, const Inputs& inputs) noexcept {
  begins_ = false;
  approach_start_s_ = t_s;
  approach_from_m_ = inputs.position_m;
  approach_to_m_ = reference_.at(0.0).d[0];
  const double way = std::fabs(approach_to_m_ - approach_from_m_);
  const bool goes = way > tolerance_m_;
  const double duration =
      goes ? std::max(approach_shortest_s, approach_peak_over_mean * way / approach_speed_mps) : 0.0;
  const auto whole_periods = [&](double time_s) { return period_s_ * std::ceil(time_s / period_s_); };
  approach_end_s_ = t_s + whole_periods(duration);
  const double rest_s = controller_.rest_s(goes || moved_, {inputs.port_1_Pa, inputs.port_2_Pa});
  reference_start_s_ = approach_end_s_ + whole_periods(rest_s);
  moved_ = false;
}

ReferencePoint AxisLoop::reference_at(double t_s) const noexcept {
  if (t_s >= reference_start_s_) return reference_.at(t_s - reference_start_s_);
  ReferencePoint point;
  point.d[0] = approach_to_m_;
  if (t_s >= approach_end_s_) return point;
  // x = from + way s(z), z = time/duration; a derivative of s by t is one by z over the duration.
  static constexpr auto smooth = smoothstep_coefficients(approach_degree);
  const double duration = approach_end_s_ - approach_start_s_, way = approach_to_m_ - approach_from_m_;
  const double z = std::clamp((t_s - approach_start_s_) / duration, 0.0, 1.0);
  std::array<double, smoothstep_degree_max + 1> c = smooth;
  double scale = way;
  for (std::size_t order = 0; order < point.d.size(); ++order) {
    double value = 0.0;
    for (std::size_t i = approach_degree + 1; i-- > 0;) value = value * z + c[i];
    point.d[order] = scale * value + (order == 0 ? approach_from_m_ : 0.0);
    for (std::size_t i = 0; i < approach_degree; ++i) c[i] = static_cast<double>(i + 1) * c[i + 1];
    c[approach_degree] = 0.0;
    scale /= duration;
  }
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

std::array<double, 2> AxisLoop::control(double t_s, const Inputs& inputs, const EstimatorOutput& estimate) noexcept {
  if (begins_) plan_motion(t_s, inputs);
  // What the last move teaches is not known yet: one period more of rest.
  if (learning_due() && t_s >= reference_start_s_) reference_start_s_ = t_s + period_s_;
  if (Ppd2GainSet gains; gain_mailbox_ != nullptr && gain_mailbox_->take(gains)) controller_.change_gains(gains);
  now_ = reference_at(t_s);
  const double lead_s = controller_.lead_s();
  ControlInput in{inputs.position_m, pressures(inputs, estimate), {inputs.port_1_Pa, inputs.port_2_Pa}, now_, now_};
  if (lead_s > 0.0) in.ahead = reference_at(t_s + lead_s);
  in.tick = std::llround((t_s - reference_start_s_) / period_s_);
  const ControlOutput out = controller_.step(in);
  velocity_mps_ = out.speed_mps;
  limited_ = out.limited;
  std::uint64_t faults = check_standstill();
  if (!out.finite) faults |= fault_command_not_finite;
  if (std::fabs(velocity_mps_) > speed_limit_mps_) faults |= fault_speed;
  if (source_ == PressureSource::estimated && !(estimate.valid[0] && estimate.valid[1]))
    faults |= fault_estimate_invalid;
  if (faults != 0) latch(faults);
  return out.command_V;
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
  const Inputs inputs = guard(measured, skipped);
  // Skipped slots passed without a sample: the model goes through them with the newest one.
  for (std::int64_t i = 0; i < std::min<std::int64_t>(skipped, most_caught_up_steps); ++i)
    estimator_.step({inputs.port_1_Pa, inputs.port_2_Pa, inputs.position_m, velocity_mps_, command_V_[0]});
  controller_.skip(skipped);
  const EstimatorOutput estimate =
      estimator_.step({inputs.port_1_Pa, inputs.port_2_Pa, inputs.position_m, velocity_mps_, command_V_[0]});
  stamp(&StageTimes::estimated);
  std::array<double, 2> command_V = safe_V_;
  limited_ = false;
  if (faults_ == 0 && !stopped_ && !waiting()) command_V = control(t_s, inputs, estimate);
  if (faults_ != 0) command_V = safe_V_;
  stamp(&StageTimes::controlled);
  const bool active = faults_ == 0 && !stopped_ && !waiting();
  if (!backend.write(tick, {command_V[0], command_V[1], active})) {
    latch(fault_output_missed);
    command_V = safe_V_;
    backend.write(tick, {command_V[0], command_V[1]});
  }
  note_commands(command_V);
  if (faults_ != 0) limited_ = false;
  stamp(&StageTimes::written);
  fill_row(t_s, skipped, measured, truth, estimate);
  return true;
}

void AxisLoop::stop(Backend& backend, std::int64_t tick) noexcept {
  stopped_ = true;
  note_commands(safe_V_);
  backend.write(tick, {command_V_[0], command_V_[1]});
}

void AxisLoop::fill_row(double t_s, std::int64_t skipped, const Measurement& measured, const Truth& truth,
                        const EstimatorOutput& estimate) noexcept {
  const auto recorded = [](const Channel& channel) { return channel.valid ? channel.value : Row::none; };
  const bool estimated = (estimate.health & estimator_not_started) == 0;
  const auto known = [](bool is_known, double value) { return is_known ? value : Row::none; };
  row_.t_s = t_s;
  row_.x_ref_m = known(!begins_, now_.d[0]);
  row_.v_ref_mps = known(!begins_, now_.d[1]);
  row_.x_m = recorded(measured.position_m);
  row_.v_mps = velocity_mps_;
  const bool two_valves = rig_ == RigKind::servo_table;
  row_.u_V = known(!two_valves, command_V_[0]);
  row_.u1_V = known(two_valves, command_V_[0]);
  row_.u2_V = known(two_valves, command_V_[1]);
  const bool has_gains = controller_.kind() == ControllerKind::ppd2;
  const Ppd2GainSet gains = controller_.ppd2().gains();
  row_.position_gain_V_per_m = known(has_gains, gains.position_gain_V_per_m);
  row_.velocity_gain_Vs_per_m = known(has_gains, gains.velocity_gain_Vs_per_m);
  row_.acceleration_gain_Vs2_per_m = known(has_gains, gains.acceleration_gain_Vs2_per_m);
  row_.integral_gain_V_per_m_s = known(has_gains, gains.integral_gain_V_per_m_s);
  row_.p1_port_Pa = recorded(measured.port_pressure_1_Pa);
  row_.p2_port_Pa = recorded(measured.port_pressure_2_Pa);
  row_.p1_chamber_Pa = recorded(measured.chamber_pressure_1_Pa);
  row_.p2_chamber_Pa = recorded(measured.chamber_pressure_2_Pa);
  row_.p1_estimated_Pa = known(estimated, estimate.chamber_pressure_Pa[0]);
  row_.p2_estimated_Pa = known(estimated, estimate.chamber_pressure_Pa[1]);
  row_.p1_bound_Pa = known(estimated, estimate.error_bound_Pa[0]);
  row_.p2_bound_Pa = known(estimated, estimate.error_bound_Pa[1]);
  row_.mass_flow_1_kgps = known(estimated, estimate.mass_flow_kgps[0]);
  row_.mass_flow_2_kgps = known(estimated, estimate.mass_flow_kgps[1]);
  row_.p_supply_Pa = recorded(measured.supply_pressure_Pa);
  row_.x_true_m = truth.position_m;
  row_.p1_chamber_true_Pa = truth.chamber_pressure_1_Pa;
  row_.p2_chamber_true_Pa = truth.chamber_pressure_2_Pa;
  row_.flags =
      (skipped > 0 ? row_overrun : 0u) | (limited_ ? row_command_limited : 0u) | (faults_ != 0 ? row_fault : 0u);
  row_.fault = faults_;
}

}  // namespace pneuservo
