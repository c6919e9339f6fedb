// The one pass of the control loop.
#include <pneuservo/loop/axis_loop.hpp>

#include <algorithm>
#include <cmath>

#include "loop/motion_limits.hpp"
#include "pass/command_pass.hpp"
#include "pass/move_pass.hpp"

namespace pneuservo {
namespace {

double tolerance_of(const Rig& rig, const char* path) {
  const auto found = rig.tolerances.find(path);
  return found == rig.tolerances.end() ? 0.0 : found->second;
}

constexpr std::int64_t most_held_periods = 100;    // of the prediction, some 10 us

/// Every law's terms fit into a row and have names that no column of every run has.
constexpr bool terms_have_columns() {
  for (std::size_t law = 0; law < law_count; ++law) {
    const auto names = law_columns(static_cast<ControllerKind>(law));
    if (names.size() > Row::most_terms) return false;
    bool is_taken = false;
    Row::visit(
        [&](std::string_view column) { is_taken = is_taken || std::ranges::find(names, column) != names.end(); });
    if (is_taken) return false;
  }
  return true;
}
static_assert(terms_have_columns(), "a law has more terms than Row::most_terms, or one with the name of a column");

}  // namespace

AxisLoop::AxisLoop() = default;
AxisLoop::~AxisLoop() = default;

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
  p.arrangement = valve_arrangement(rig);
  p.flow_correction = rig.estimator.flow_correction;
  p.effects = rig.axis.effects;
  p.frequency_dependent_losses = rig.estimator.frequency_dependent_losses;
  SensorCorrection sensors;
  sensors.configure(rig);
  p.uncertainty.port_noise_Pa = rig.sensors.port_pressure.rms_Pa() *
                                std::max(sensors.noise_factor(Signal::p1_port), sensors.noise_factor(Signal::p2_port));
  p.uncertainty.relative_diameter =
      std::max(tolerance_of(rig, "line_1.diameter_m"), tolerance_of(rig, "line_2.diameter_m"));
  p.uncertainty.relative_area =
      std::max(tolerance_of(rig, "cylinder.area_1_m2"), tolerance_of(rig, "cylinder.area_2_m2"));
  p.uncertainty.relative_valve_area = tolerance_of(rig, "valve.area_per_volt_m2_per_V");
  return p;
}

void AxisLoop::configure(const Rig& wanted, const LoadPositions& load) {
  Rig rig = wanted;
  period_s_ = rig.period_s;
  valves_ = rig.valves();
  command_max_V_ = rig.axis.valve.command_max_V;
  estimator_.configure(estimator_parameters(rig));
  reference_ = Reference(rig.reference, load);
  PassTables pass = pass_or_formula(rig, reference_, PassWords::short_words).tables;
  controller_.configure(rig.controller, rig.axis, rig.period_s, reference_, rig.duration_s, std::move(pass.law));
  pass_maker_.reset();
  if (rig.reference.kind == ReferenceKind::live) configure_desk(rig);
  source_ = controller_.pressure_source();
  tolerance_m_ =
      std::min(approach_tolerance_m, approach_quanta * (rig.sensors.position.quantum_m + rig.sensors.position.noise_m));
  const auto& cylinder = rig.axis.cylinder;
  area_1_m2_ = cylinder.area_1_m2;
  area_2_m2_ = cylinder.area_2_m2;
  atmosphere_force_N_ = (area_1_m2_ - area_2_m2_) * rig.axis.air.atmosphere_Pa;
  const MotionPrediction prediction = predict_motion(rig, reference_, std::move(pass.prediction));
  twin_ = prediction.twin;
  encoderless_.configure(rig);
  supervisor_.configure(rig, source_ == PressureSource::chamber, prediction.limits);
  rearm();
}

void AxisLoop::configure_desk(const Rig& rig) {
  const bool has_passes = rig.controller.wants_pass();
  desk_.configure(live_limits(rig.reference), rig.period_s, controller_.lead_s(),
                  has_passes ? rig.reference.pass_within_s : 0.0);
  if (has_passes) pass_maker_ = std::make_unique<MovePassMaker>(rig);
}

std::string AxisLoop::make_pass() {
  MovePassRequest request;
  if (!pass_maker_ || !move_passes_.take_request(request)) return {};
  const std::uint64_t number = request.move.number;
  MovePass& pass = move_passes_.draft();
  pass.number = number;
  std::string why = pass_maker_->make(request, pass, [&] { return move_passes_.is_awaited(number); });
  move_passes_.post_draft();
  return why.empty() && move_passes_.was_missed(number) ? MovePassMaker::late_words(request.move) : why;
}

void AxisLoop::rearm() noexcept {
  waits_for_pass_ = follows_pass_ = pass_begins_ = false;
  move_passes_.drop(planned_);
  may_move_still_ = supervisor_.has_moved();
  stood_at_m_ = Row::none;
  stood_s_ = 0.0;
  supervisor_.allow_motion(may_start());
  begins_ = twin_waits_ = true;
  moved_ = limited_ = false;
  velocity_mps_ = 0.0;
  encoderless_.reset();
  supervisor_.tell_position(encoderless_.shown_m());
  estimator_.reset();
  controller_.reset(supervisor_.command_V());
  supervisor_.rearm();
}

// From here to the reference's first value, at rest at both ends, a rest there, then the reference's own time begins.
void AxisLoop::plan_motion(double t_s, const JudgedInputs& inputs) noexcept {
  begins_ = false;
  const double to_m = reference_.at(0.0).d[0];
  const bool goes = std::fabs(to_m - inputs.position_m) > tolerance_m_;
  approach_.plan(t_s, inputs.position_m, to_m, goes, period_s_);
  const double rest_s = controller_.rest_s(goes || moved_, inputs.port_Pa);
  reference_start_s_ = approach_.end_s() + period_s_ * std::ceil(rest_s / period_s_);
  moved_ = false;
}

ReferencePoint AxisLoop::reference_at(double t_s) const noexcept {
  return t_s >= reference_start_s_ ? reference_.at(t_s - reference_start_s_) : approach_.at(t_s);
}

// Where the slider shall be in this tick, and for the law at its lead.
void AxisLoop::set_points(double t_s, std::int64_t tick, const JudgedInputs& inputs) noexcept {
  const double lead_s = controller_.lead_s();
  if (desk_.is_open()) {
    if (begins_) reference_start_s_ = t_s;
    desk_.move(tick, begins_, inputs.position_m, supervisor_.motion().proven());
    begins_ = false;
    now_ = desk_.motion().at(tick, 0.0);
    control_in_.ahead = lead_s > 0.0 ? desk_.motion().at(tick, lead_s / period_s_) : now_;
    return;
  }
  if (begins_) plan_motion(t_s, inputs);
  // What the last move teaches is not known yet: one period more of rest.
  if (learning_due() && t_s >= reference_start_s_) reference_start_s_ = t_s + period_s_;
  now_ = reference_at(t_s);
  control_in_.ahead = lead_s > 0.0 ? reference_at(t_s + lead_s) : now_;
}

std::array<double, 2> AxisLoop::control(std::int64_t tick, const JudgedInputs& inputs, const EstimatorOutput& estimate,
                                        std::int64_t skipped) noexcept {
  const double t_s = static_cast<double>(tick) * period_s_;
  set_points(t_s, tick, inputs);
  if (Ppd2GainSet gains; gain_mailbox_ != nullptr && gain_mailbox_->take(gains)) {
    controller_.change_gains(gains);
    twin_.change_gains(gains);
  }
  ControlInput& in = control_in_;
  in.x_m = inputs.position_m;
  in.pressure_Pa = pressures(inputs, estimate);
  in.port_Pa = inputs.port_Pa;
  in.supply_Pa = inputs.supply_Pa;
  in.now = now_;
  in.tick = std::llround((t_s - reference_start_s_) / period_s_);
  if (pass_maker_) follow_passes(tick);
  if (twin_waits_) twin_.start(in.x_m, in.pressure_Pa, supervisor_.command_V());
  else if (skipped > 0) twin_.hold(std::min<std::int64_t>(skipped, most_held_periods));
  twin_waits_ = false;
  ControlOutput out = controller_.step(in);
  velocity_mps_ = out.speed_mps;
  const double most_V = supervisor_.motion().most_command_V();
  limited_ = out.limited || std::fabs(out.command_V[0]) > most_V || std::fabs(out.command_V[1]) > most_V;
  const bool within = std::fabs(out.command_V[0]) <= command_max_V_ && std::fabs(out.command_V[1]) <= command_max_V_;
  const bool estimated =
      source_ == PressureSource::estimated || (source_ == PressureSource::differential && inputs.is_beyond_range());
  const bool usable = !estimated || (estimate.valid[0] && estimate.valid[1]);
  supervisor_.check_motion({motion_sample(in, skipped), out.finite && within, usable});
  for (double& command_V : out.command_V) command_V = std::clamp(command_V, -most_V, most_V);
  return out.command_V;
}

// Another plan ends what the last pass gives, and one from rest gets a pass of its own before it begins.
void AxisLoop::follow_passes(std::int64_t tick) noexcept {
  const PlannedMove& move = desk_.motion().planned();
  pass_begins_ = false;
  const auto follow = [&](const MovePass* pass, std::int64_t from) {
    const bool is_change = pass != nullptr || follows_pass_;
    follows_pass_ = pass != nullptr;
    if (!is_change) return;
    controller_.follow_pass(pass != nullptr ? std::span(pass->law) : std::span<const PassTick>(), from);
    twin_.follow_pass(pass != nullptr ? std::span(pass->prediction) : std::span<const PassTick>(), from);
  };
  if (move.number != planned_) {
    planned_ = move.number;
    waits_for_pass_ = move.from_rest;
    if (move.from_rest) move_passes_.request({move, control_in_.pressure_Pa[0]});
    else move_passes_.drop(move.number), follow(nullptr, 0);
  }
  if (!waits_for_pass_ || tick < move.begin_tick) return;
  waits_for_pass_ = false;
  follow(move_passes_.take(move.number), control_in_.tick - (tick - move.begin_tick));
  pass_begins_ = follows_pass_;
}

// The prediction begins at rest: an axis that still moves, or was seen moving while a channel was waited for, is not
// taken over.
void AxisLoop::note_rest(const JudgedInputs& inputs, std::int64_t skipped) noexcept {
  if (!(std::fabs(inputs.position_m - stood_at_m_) <= supervisor_.motion().limits().standing_m)) {
    may_move_still_ = may_move_still_ || std::isfinite(stood_at_m_);
    stood_at_m_ = inputs.position_m;
    stood_s_ = 0.0;
  } else stood_s_ += static_cast<double>(skipped + 1) * period_s_;
  supervisor_.allow_motion(may_start());
}

MotionSample AxisLoop::motion_sample(const ControlInput& in, std::int64_t skipped) const noexcept {
  const double force_N = area_1_m2_ * in.pressure_Pa[0] - area_2_m2_ * in.pressure_Pa[1] - atmosphere_force_N_;
  return {.position_m = in.x_m,
          .predicted_m = twin_.position_m(),
          .reference_m = in.now.d[0],
          .speed_mps = velocity_mps_,
          .predicted_mps = twin_.velocity_mps(),
          .force_N = force_N,
          .periods = static_cast<double>(skipped + 1),
          .doubt_m = encoderless_.doubt_m(),
          .doubt_mps = encoderless_.doubt_mps()};
}

EstimatorOutput AxisLoop::estimate(const JudgedInputs& inputs, std::int64_t skipped) noexcept {
  EstimatorInput in{inputs.port_Pa[0], inputs.port_Pa[1], inputs.position_m, velocity_mps_, supervisor_.command_V()[0]};
  if (encoderless_.is_on()) [[unlikely]]
    in.x_m = encoderless_.position_m(), in.v_mps = encoderless_.velocity_mps(), in.shift_m = encoderless_.shift_m();
  if (valves_ == 2) in.valve_command_2_V = supervisor_.command_V()[1];
  // Skipped slots passed without a sample: the model goes through them with the newest one.
  for (std::int64_t i = 0; i < std::min(skipped, most_caught_up_periods); ++i) {
    estimator_.step(in);
    in.shift_m = 0.0;
  }
  return estimator_.step(in);
}

void AxisLoop::watch_position(const DigitalInputs& digital, const JudgedInputs& inputs, const EstimatorOutput& estimate,
                              std::int64_t skipped) noexcept {
  encoderless_x_m_ = encoderless_.position_m(), encoderless_bound_m_ = encoderless_.bound_m();
  encoderless_.step(supervisor_.command_V(), inputs.port_Pa, inputs.supply_Pa, estimate, skipped);
  encoderless_.see(digital);
  supervisor_.tell_position(encoderless_.shown_m());
  if (encoderless_.is_lost()) supervisor_.latch(fault_position_unknown);
}

void AxisLoop::tell_status(std::int64_t tick) noexcept {
  desk_.tell(tick, supervisor_,
             {.t_s = row_.t_s,
              .proven = supervisor_.motion().proven(),
              .follows_pass = follows_pass_,
              .measured = told_readings(),
              .v_mps = row_.v_mps,
              .set_point = row_.x_ref_m,
              .set_point_rate = row_.v_ref_mps});
}

void AxisLoop::fill_row(double t_s, std::int64_t skipped, bool stepped, const Measurement& measured, const Truth& truth,
                        const EstimatorOutput& estimate) noexcept {
  const bool estimated = (estimate.health & estimator_not_started) == 0;
  const auto known = [](bool is_known, double value) { return is_known ? value : Row::none; };
  const AxisCommand& asked = desk_.command();
  const bool commanded = desk_.obeyed() != CommandKind::none;
  const bool two_valves = valves_ == 2;
  for (const Signal signal : channel_signals) {
    const Channel& channel = measured.channel[signal];
    row_.measured[signal] = channel.valid ? channel.value : Row::none;
  }
  controller_.write_terms(stepped, row_.terms);
#define PNEUSERVO_SET(type, name, initial, value) row_.name = value;
#define PNEUSERVO_SET_MEASURED(first, last)
  PNEUSERVO_ROW_COLUMNS(PNEUSERVO_SET, PNEUSERVO_SET, PNEUSERVO_SET, PNEUSERVO_SET_MEASURED)
#undef PNEUSERVO_SET
#undef PNEUSERVO_SET_MEASURED
}

}  // namespace pneuservo
