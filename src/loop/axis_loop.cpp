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
  p.uncertainty.port_noise_Pa = rig.sensors.port_pressure.rms_Pa();
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
  command_max_V_ = rig.axis.valve.command_max_V;
  estimator_.configure(estimator_parameters(rig));
  reference_ = Reference(rig.reference, load);
  controller_.configure(rig.controller, rig.axis, rig.period_s, reference_, rig.duration_s);
  source_ = controller_.pressure_source();
  tolerance_m_ =
      std::min(approach_tolerance_m, approach_quanta * (rig.sensors.position.quantum_m + rig.sensors.position.noise_m));
  supervisor_.configure(rig, source_ == PressureSource::chamber);
  rearm();
}

void AxisLoop::rearm() noexcept {
  begins_ = true;
  moved_ = limited_ = false;
  velocity_mps_ = 0.0;
  estimator_.reset();
  controller_.reset(supervisor_.command_V());
  supervisor_.rearm();
}

// From here to the reference's first value, at rest at both ends, a rest there, then the reference's own time begins.
void AxisLoop::plan_motion(double t_s, const JudgedInputs& inputs) noexcept {
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
  const double rest_s = controller_.rest_s(goes || moved_, inputs.port_Pa);
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

std::array<double, 2> AxisLoop::pressures(const JudgedInputs& inputs, const EstimatorOutput& estimate) const noexcept {
  switch (source_) {
    case PressureSource::valve: return inputs.port_Pa;
    case PressureSource::chamber: return inputs.chamber_Pa;
    case PressureSource::estimated: break;
  }
  return {estimate.chamber_pressure_Pa[0], estimate.chamber_pressure_Pa[1]};
}

std::array<double, 2> AxisLoop::control(double t_s, const JudgedInputs& inputs,
                                        const EstimatorOutput& estimate) noexcept {
  if (begins_) plan_motion(t_s, inputs);
  // What the last move teaches is not known yet: one period more of rest.
  if (learning_due() && t_s >= reference_start_s_) reference_start_s_ = t_s + period_s_;
  if (Ppd2GainSet gains; gain_mailbox_ != nullptr && gain_mailbox_->take(gains)) controller_.change_gains(gains);
  now_ = reference_at(t_s);
  const double lead_s = controller_.lead_s();
  ControlInput in{inputs.position_m, pressures(inputs, estimate), inputs.port_Pa, now_, now_};
  if (lead_s > 0.0) in.ahead = reference_at(t_s + lead_s);
  in.tick = std::llround((t_s - reference_start_s_) / period_s_);
  const ControlOutput out = controller_.step(in);
  velocity_mps_ = out.speed_mps;
  limited_ = out.limited;
  const bool within = std::fabs(out.command_V[0]) <= command_max_V_ && std::fabs(out.command_V[1]) <= command_max_V_;
  const bool usable = source_ != PressureSource::estimated || (estimate.valid[0] && estimate.valid[1]);
  supervisor_.check_motion({out.speed_mps, now_.d[0], out.finite && within, usable});
  return out.command_V;
}

EstimatorOutput AxisLoop::estimate(const JudgedInputs& inputs, std::int64_t skipped) noexcept {
  const EstimatorInput in{inputs.port_Pa[0], inputs.port_Pa[1], inputs.position_m, velocity_mps_,
                          supervisor_.command_V()[0]};
  // Skipped slots passed without a sample: the model goes through them with the newest one.
  for (std::int64_t i = 0; i < std::min<std::int64_t>(skipped, most_caught_up_steps); ++i) estimator_.step(in);
  return estimator_.step(in);
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
  const JudgedInputs inputs = supervisor_.judge(measured, skipped);
  controller_.skip(skipped);
  const EstimatorOutput estimated = estimate(inputs, skipped);
  supervisor_.cross_check(inputs, estimated, skipped);
  stamp(&StageTimes::estimated);
  std::array<double, 2> command_V = supervisor_.safe_V();
  limited_ = false;
  if (supervisor_.is_active()) command_V = control(t_s, inputs, estimated);
  if (!supervisor_.is_active()) command_V = supervisor_.safe_V();
  stamp(&StageTimes::controlled);
  const bool ended = supervisor_.faults() != 0;
  if (!backend.write(tick, {command_V[0], command_V[1], supervisor_.is_active(), ended})) {
    supervisor_.latch(fault_output_missed);
    command_V = supervisor_.safe_V();
    backend.write(tick, {command_V[0], command_V[1], false, true});
  }
  supervisor_.note_commands(command_V);
  if (!supervisor_.is_active()) limited_ = false;
  stamp(&StageTimes::written);
  fill_row(t_s, skipped, measured, truth, estimated);
  return true;
}

void AxisLoop::stop(Backend& backend, std::int64_t tick) noexcept {
  supervisor_.stop();
  const std::array<double, 2>& safe_V = supervisor_.safe_V();
  supervisor_.note_commands(safe_V);
  backend.write(tick, {safe_V[0], safe_V[1], false, true});
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
  row_.u_V = known(!two_valves, supervisor_.command_V()[0]);
  row_.u1_V = known(two_valves, supervisor_.command_V()[0]);
  row_.u2_V = known(two_valves, supervisor_.command_V()[1]);
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
  row_.state = static_cast<std::uint32_t>(supervisor_.state());
  row_.flags = (skipped > 0 ? row_overrun : 0u) | (limited_ ? row_command_limited : 0u) |
               (supervisor_.faults() != 0 ? row_fault : 0u) | (supervisor_.bridged() ? row_input_bridged : 0u);
  row_.fault = supervisor_.faults();
}

}  // namespace pneuservo
