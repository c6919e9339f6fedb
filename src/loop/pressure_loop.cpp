// The pass of a pressure rig.
#include <pneuservo/loop/pressure_loop.hpp>

#include <algorithm>
#include <cmath>

#include <pneuservo/loop/axis_loop.hpp>

namespace pneuservo {
namespace {

constexpr std::int64_t most_periods_caught_up = 10;  // a late tick must not grow long itself

}  // namespace

void PressureLoop::configure(const Rig& rig) {
  period_s_ = rig.period_s;
  command_max_V_ = rig.axis.valve.command_max_V;
  pressure_limit_Pa_ = rig.limits.pressure_Pa.value_or(pressure_limit_Pa(rig));
  estimator_.configure(estimator_parameters(rig));
  growth_.configure(rig);
  grows_ = rig.volume.compliance_m3_per_Pa > 0.0;
  reference_ = PressureReference(rig.pressure_reference);
  controller_.configure(rig.controller, rig.axis, rig.period_s, reference_.smooth(), rig.duration_s, {}, &rig.volume);
  source_ = controller_.pressure_source();
  supervisor_.configure(rig, source_ == PressureSource::chamber);
  controller_.reset(supervisor_.command_V());
  begins_ = true;
  estimated_ = false;
}

// The volume grows with the estimate of the period before.
EstimatorOutput PressureLoop::estimate(const JudgedInputs& inputs, std::int64_t skipped) noexcept {
  const double port_Pa = inputs.port_Pa[0];
  EstimatorOutput out;
  for (std::int64_t i = std::min(skipped, most_periods_caught_up); i >= 0; --i) {
    if (!estimated_ && std::isfinite(port_Pa)) growth_.reset(port_Pa);
    out = estimator_.step({port_Pa, port_Pa, growth_.position_m(), 0.0, supervisor_.command_V()[0]});
    estimated_ = (out.health & estimator_not_started) == 0;
    if (grows_ && estimated_)
      growth_.step(out.chamber_pressure_Pa[0], out.chamber_temperature_K[0], out.mass_flow_kgps[0]);
  }
  return out;
}

double PressureLoop::controlled_Pa(const JudgedInputs& inputs, const EstimatorOutput& estimate) const noexcept {
  switch (source_) {
    case PressureSource::valve: return inputs.port_Pa[0];
    case PressureSource::chamber: return inputs.chamber_Pa[0];
    case PressureSource::estimated: break;
  }
  return estimate.chamber_pressure_Pa[0];
}

// A soft volume bursts at a pressure that its port may well have while it is filled.
void PressureLoop::watch_volume(const JudgedInputs& inputs, const EstimatorOutput& estimate) noexcept {
  const bool estimated_above = estimated_ && estimate.chamber_pressure_Pa[0] > pressure_limit_Pa_;
  if (estimated_above || inputs.chamber_Pa[0] > pressure_limit_Pa_) supervisor_.latch(fault_pressure_limit);
}

double PressureLoop::control(double t_s, const JudgedInputs& inputs, const EstimatorOutput& estimate) noexcept {
  if (begins_) reference_start_s_ = t_s;
  begins_ = false;
  ControlInput in;
  in.pressure_Pa.fill(controlled_Pa(inputs, estimate));
  in.port_Pa = inputs.port_Pa;
  in.supply_Pa = inputs.supply_Pa;
  in.now = in.ahead = reference_.at(t_s - reference_start_s_);
  in.tick = std::llround((t_s - reference_start_s_) / period_s_);
  p_ref_Pa_ = in.now.d[0];
  const ControlOutput out = controller_.step(in);
  limited_ = out.limited;
  if (!out.finite || !(std::fabs(out.command_V[0]) <= command_max_V_)) supervisor_.latch(fault_command_not_finite);
  if (source_ == PressureSource::estimated && !estimate.valid[0]) supervisor_.latch(fault_estimate_invalid);
  return out.command_V[0];
}

bool PressureLoop::pass(Backend& backend, std::int64_t tick, std::int64_t skipped, StageTimes* times,
                        std::int64_t (*now)() noexcept) noexcept {
  const auto stamp = [&](std::int64_t StageTimes::* stage) {
    if (times != nullptr) times->*stage = now();
  };
  const double t_s = static_cast<double>(tick) * period_s_;
  stamp(&StageTimes::start);
  Measurement measured;
  if (!backend.read(tick, measured)) return false;
  const Truth truth = backend.truth();  // for the row alone
  stamp(&StageTimes::read);
  const JudgedInputs inputs = supervisor_.judge(measured, skipped);
  controller_.skip(skipped);
  const EstimatorOutput estimated = estimate(inputs, skipped);
  supervisor_.cross_check(inputs, estimated, skipped);
  watch_volume(inputs, estimated);
  stamp(&StageTimes::estimated);
  limited_ = false;
  const bool stepped = supervisor_.is_active();
  double command_V = stepped ? control(t_s, inputs, estimated) : 0.0;
  if (!supervisor_.is_active()) command_V = supervisor_.safe_V()[0];
  stamp(&StageTimes::controlled);
  if (!backend.write(tick, {command_V, command_V, supervisor_.is_active(), supervisor_.faults() != 0})) {
    supervisor_.latch(fault_output_missed);
    command_V = supervisor_.safe_V()[0];
    backend.write(tick, {command_V, command_V, false, true});
  }
  supervisor_.note_commands({command_V, command_V});
  limited_ = limited_ && supervisor_.is_active();
  stamp(&StageTimes::written);
  fill_row(t_s, skipped, stepped, measured, truth, estimated);
  return true;
}

void PressureLoop::stop(Backend& backend, std::int64_t tick) noexcept {
  supervisor_.stop();
  const std::array<double, 2>& safe_V = supervisor_.safe_V();
  supervisor_.note_commands(safe_V);
  backend.write(tick, {safe_V[0], safe_V[1], false, true});
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
  row_.state = static_cast<std::uint32_t>(supervisor_.state());
  row_.flags = (skipped > 0 ? row_overrun : 0u) | (limited_ ? row_command_limited : 0u) |
               (supervisor_.faults() != 0 ? row_fault : 0u) | (supervisor_.bridged() ? row_input_bridged : 0u);
  row_.fault = supervisor_.faults();
  controller_.write_terms(stepped, row_.terms);
}

}  // namespace pneuservo
