// The pass of a pressure rig.
#include <pneuservo/loop/pressure_loop.hpp>

#include <algorithm>
#include <cmath>

#include <pneuservo/loop/axis_loop.hpp>

namespace pneuservo {
void PressureLoop::configure(const Rig& rig) {
  period_s_ = rig.period_s;
  command_max_V_ = rig.axis.valve.command_max_V;
  pressure_limit_Pa_ = chamber_pressure_limit_Pa(rig);
  estimator_.configure(estimator_parameters(rig));
  growth_.configure(rig);
  grows_ = rig.volume.compliance_m3_per_Pa > 0.0;
  reference_ = PressureReference(rig.pressure_reference);
  if (rig.pressure_reference.kind == PressureReferenceKind::live)
    desk_.configure(live_limits(rig.pressure_reference), rig.period_s, 0.0);
  controller_.configure(rig.controller, rig.axis, rig.period_s, reference_.smooth(), rig.duration_s, {}, &rig.volume);
  source_ = controller_.pressure_source();
  supervisor_.configure(rig, source_ == PressureSource::chamber);
  rearm();
}

void PressureLoop::rearm() noexcept {
  supervisor_.allow_motion(may_start());
  begins_ = true;
  estimated_ = limited_ = false;
  estimator_.reset();
  controller_.reset(supervisor_.command_V());
  supervisor_.rearm();
}

// Of a commanded loop where it is at first, else of its reference.
ReferencePoint PressureLoop::set_point(std::int64_t tick, double p_Pa) noexcept {
  const double t_s = static_cast<double>(tick) * period_s_;
  if (begins_) reference_start_s_ = t_s;
  if (desk_.is_open()) desk_.move(tick, begins_, p_Pa, true);
  begins_ = false;
  return desk_.is_open() ? desk_.motion().at(tick) : reference_.at(t_s - reference_start_s_);
}

void PressureLoop::tell_status(std::int64_t tick) noexcept {
  desk_.tell(tick, supervisor_,
             {.t_s = row_.t_s,
              .proven = true,
              .measured = told_readings(),
              .p_Pa = p_Pa_,
              .set_point = row_.p_ref_Pa,
              .set_point_rate = p_ref_Pa_per_s_,
              .is_late = limited_});
}

// The volume grows with the estimate of the period before.
EstimatorOutput PressureLoop::estimate(const JudgedInputs& inputs, std::int64_t skipped) noexcept {
  const double port_Pa = inputs.port_Pa[0], command_V = supervisor_.command_V()[0];
  EstimatorOutput out;
  for (std::int64_t i = std::min(skipped, most_caught_up_periods); i >= 0; --i) {
    if (!estimated_ && std::isfinite(port_Pa)) growth_.reset(port_Pa);
    out = estimator_.step({port_Pa, port_Pa, growth_.position_m(), 0.0, command_V, command_V});
    estimated_ = (out.health & estimator_not_started) == 0;
    if (grows_ && estimated_)
      growth_.step(out.chamber_pressure_Pa[0], out.chamber_temperature_K[0], out.mass_flow_kgps[0]);
  }
  return out;
}

// A soft volume bursts at a pressure that its port may well have while it is filled.
void PressureLoop::watch(const Measurement&, const JudgedInputs& inputs, const EstimatorOutput& estimate,
                         std::int64_t) noexcept {
  p_Pa_ = estimated_ || source_ != PressureSource::estimated ? pressures(inputs, estimate)[0] : Row::none;
  const bool estimated_above = estimated_ && estimate.chamber_pressure_Pa[0] > pressure_limit_Pa_;
  if (estimated_above || inputs.chamber_Pa[0] > pressure_limit_Pa_) supervisor_.latch(fault_pressure_limit);
}

std::array<double, 2> PressureLoop::control(std::int64_t tick, const JudgedInputs& inputs,
                                            const EstimatorOutput& estimate, std::int64_t) noexcept {
  ControlInput in;
  in.pressure_Pa.fill(pressures(inputs, estimate)[0]);
  in.port_Pa = inputs.port_Pa;
  in.supply_Pa = inputs.supply_Pa;
  in.now = in.ahead = set_point(tick, in.pressure_Pa[0]);
  in.tick = tick - std::llround(reference_start_s_ / period_s_);
  p_ref_Pa_ = in.now.d[0];
  p_ref_Pa_per_s_ = in.now.d[1];
  const ControlOutput out = controller_.step(in);
  limited_ = out.limited;
  if (!out.finite || !(std::fabs(out.command_V[0]) <= command_max_V_)) supervisor_.latch(fault_command_not_finite);
  if (source_ == PressureSource::estimated && !estimate.valid[0]) supervisor_.latch(fault_estimate_invalid);
  return {out.command_V[0], out.command_V[0]};
}

void PressureLoop::fill_row(double t_s, std::int64_t skipped, bool stepped, const Measurement& measured,
                            const Truth& truth, const EstimatorOutput& estimate) noexcept {
  const auto known = [this](double value) { return estimated_ ? value : Row::none; };
  row_ = Row{};
  row_.t_s = t_s;
  row_.p_ref_Pa = stepped ? p_ref_Pa_ : Row::none;
  row_.u_V = supervisor_.command_V()[0];
  for (const Signal signal : channel_signals)
    if (const Channel& channel = measured.channel[signal]; channel.valid) row_.measured[signal] = channel.value;
  row_.p1_estimated_Pa = known(estimate.chamber_pressure_Pa[0]);
  row_.p1_bound_Pa = known(estimate.error_bound_Pa[0]);
  row_.mass_flow_1_kgps = known(estimate.mass_flow_kgps[0]);
  row_.p1_chamber_true_Pa = truth.p1_chamber_Pa;
  if (desk_.obeyed() != CommandKind::none) {
    row_.command_kind = static_cast<std::uint32_t>(desk_.obeyed());
    row_.command_Pa = desk_.command().target;
    row_.command_Pa_per_s = desk_.command().rate;
    row_.command_s = desk_.command().interval_s;
  }
  row_.state = static_cast<std::uint32_t>(supervisor_.state());
  row_.flags = row_flags(skipped);
  row_.fault = supervisor_.faults();
  controller_.write_terms(stepped, row_.terms);
}

}  // namespace pneuservo
