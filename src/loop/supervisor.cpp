// The supervisor.
#include <pneuservo/loop/supervisor.hpp>

#include <algorithm>
#include <cmath>

#include <pneuservo/rig/possible_values.hpp>

namespace pneuservo {
namespace {

constexpr double margin = 2.0;            // over both estimates of steps: waves add up
constexpr double activity_time_s = 0.2;   // echoes of a change of command die out
constexpr double at_end_stop_m = 1e-3;
constexpr std::uint64_t missing_faults = [] {
  std::uint64_t all = 0;
  for (const Signal signal : channel_signals) all |= faults_of(signal).missing;
  return all;
}();

/// Of a side that a pressure rig does not have.
constexpr std::uint64_t second_side_faults = fault_flow_mismatch_2 | fault_chamber_mismatch_2;

/// A channel of which physics says no more than its PlausibleChannel.
constexpr auto no_extra = []() noexcept { return 0.0; };

/// What all channels share.
PlausibleChannel plausible(const Rig& rig) {
  return {.start_ticks = Supervisor::first_value_ticks(rig.period_s),
          .missing_ticks = static_cast<int>(rig.limits.missing_ticks),
          .oldest_s = rig.limits.age_periods * rig.period_s,
          .period_s = rig.period_s};
}

/// Steps of 5 % of the supply in a period are beyond what lines and chambers do with a calm valve; what an active one
/// and small volumes add is told tick by tick.
PlausibleChannel plausible_pressure(const Rig& rig, Signal signal) {
  const auto [quantum, noise, range] = rig.sensors.resolution(signal);
  PlausibleChannel channel = plausible(rig);
  channel.lowest = possible_pressure_Pa(rig).lowest;
  channel.highest = possible_pressure_Pa(rig).highest;
  channel.slack = sensor_slack(noise, quantum);
  // A hose that bursts takes the supply away at once: no step is too large.
  const bool any_step = info(signal).sensor == SensorKind::supply_pressure;
  channel.step_per_period = any_step ? std::numeric_limits<double>::infinity() : pressure_step_Pa(rig);
  channel.frozen_ticks = frozen_after_ticks(noise, quantum);
  return channel;
}

/// A sensor at the end of its range says so, and no more; a tenth beyond it is none of its readings.
PlausibleChannel plausible_difference(const Rig& rig, Signal signal) {
  PlausibleChannel channel = plausible(rig);
  channel.highest = 1.1 * rig.sensors.resolution(signal).range;
  channel.lowest = -channel.highest;
  return channel;
}

PlausibleChannel plausible_position(const Rig& rig, double speed_limit_mps) {
  const double noise = rig.sensors.position.noise_m, quantum = rig.sensors.position.quantum_m;
  // To lose 0.1 m/s, or 100 m/s2 where a period is long, from one sample to the next and then rest takes a blow.
  const double stopping_mps = std::max(0.1, 100.0 * rig.period_s);
  PlausibleChannel channel = plausible(rig);
  channel.lowest = possible_position_m(rig).lowest;
  channel.highest = possible_position_m(rig).highest;
  channel.slack = sensor_slack(noise, quantum);
  channel.step_per_period = 2.0 * speed_limit_mps * rig.period_s;  // below that the fault is `speed`
  channel.step_growth = most_acceleration_mps2(rig) * rig.period_s * rig.period_s;
  channel.stopping_step = stopping_mps * rig.period_s + channel.slack;
  channel.frozen_ticks = frozen_after_ticks(noise, quantum);
  return channel;
}

}  // namespace

void Supervisor::configure(const Rig& rig, bool needs_chambers, const MotionLimits& motion) {
  has_slider_ = info(rig.kind).has_slider;
  needs_chambers_ = needs_chambers;
  period_s_ = rig.period_s;
  safe_V_ = safe_commands_V(rig);
  motion_.configure(motion, rig.period_s);
  cylinder_ = rig.axis.cylinder;
  half_stroke_m_ = 0.5 * rig.axis.cylinder.stroke_m;
  position_limit_m_ = half_stroke_m_ + rig.limits.position_margin_m;
  pressure_limit_Pa_ = port_pressure_limit_Pa(rig);
  is_told_position_ = rig.position.is_estimated();
  has_losses_ = rig.has_sensor(Signal::dp1);
  needs_losses_ = rig.controller.takes_differences();
  loss_range_Pa_ = rig.sensors.differential_pressure.range_Pa;
  supply_Pa_ = rig.axis.supply.pressure_Pa;
  supply_limit_Pa_ = rig.limits.supply_share * supply_Pa_;
  lateness_limit_s_ = rig.limits.lateness_s;
  on_bus_ = rig.hal && rig.hal->can;
  port_step_Pa_per_V_ = margin * port_step_Pa_per_V(rig);
  const auto& air = rig.axis.air;
  fill_step_Pa_m3_ = margin * air.heat_capacity_ratio * air.gas_constant_J_per_kgK * air.temperature_K *
                     largest_flow_kgps_per_V(rig) * rig.axis.valve.command_max_V * rig.period_s;
  activity_decay_ = std::exp(-rig.period_s / activity_time_s);
  sensors_.configure(rig);
  PerSignal<PlausibleChannel> channels;
  for (const Signal signal : channel_signals) {
    channels[signal] = is_pressure(signal)     ? plausible_pressure(rig, signal)
                       : is_difference(signal) ? plausible_difference(rig, signal)
                                               : plausible_position(rig, motion.speed_mps);
    if (!is_difference(signal)) channels[signal].slack *= sensors_.noise_factor(signal);
    guards_[signal].configure(channels[signal]);
  }
  calm_.configure(channels, pressure_limit_Pa_);
  cross_check_.configure(rig);
  health_.configure(rig);
  command_V_ = safe_V_;
  state_ = SupervisorState::unconfigured;
  may_move_ = true;
  has_moved_ = false;
  go(SupervisorEvent::configured);
  rearm();
}

void Supervisor::rearm() noexcept {
  faults_ = first_faults_ = 0;
  bridged_ = false;
  judged_ = {};
  judged_[Signal::p1_port] = true;
  judged_[Signal::p2_port] = has_slider_;
  judged_[Signal::x] = has_slider_ && !is_told_position_;
  limits_ = {};
  for (InputGuard& guard : guards_.all) guard.reset();
  calm_.reset();
  cross_check_.reset();
  motion_.reset();
  health_.reset();
  go(SupervisorEvent::rearmed);
}

void Supervisor::latch(std::uint64_t faults) noexcept {
  if (faults == 0) return;
  if (faults_ == 0) first_faults_ = faults;
  faults_ |= faults;
  go(SupervisorEvent::fault_found);
}

template <class Extra>
double Supervisor::judge_channel(Signal signal, const Channel& channel, double periods, Extra&& extra,
                                 std::uint64_t& faults, bool at_end_stop) noexcept {
  const double value = guards_[signal].check(channel, periods, extra, at_end_stop);
  if (!guards_[signal].good()) [[unlikely]]
    faults |= doubt(signal);
  return value;
}

std::uint64_t Supervisor::doubt(Signal signal) noexcept {
  all_good_ = false;
  const SignalFaults bits = faults_of(signal);
  switch (guards_[signal].finding()) {
    case InputFinding::missing: return bits.missing;
    case InputFinding::jumped: return bits.jumped;
    case InputFinding::frozen: return bits.frozen;
    case InputFinding::bridged: bridged_ = true; return 0;
    case InputFinding::none: break;
  }
  return 0;
}

std::uint64_t Supervisor::judge_position(const Channel& position, double periods, JudgedInputs& in) noexcept {
  std::uint64_t faults = 0;
  const bool at_end_stop = std::fabs(position.value) > half_stroke_m_ - at_end_stop_m;
  in.position_m =
      is_told_position_ ? told_position_m_ : judge_channel(Signal::x, position, periods, no_extra, faults, at_end_stop);
  if (std::fabs(in.position_m) > position_limit_m_) faults |= fault_position_range;
  return faults;
}

double Supervisor::chamber_step_Pa(double dead_volume_m3, double area_m2, double way_m) const noexcept {
  return fill_step_Pa_m3_ / (dead_volume_m3 + area_m2 * std::max(way_m, 0.0));
}

std::uint64_t Supervisor::judge_pressures(const Measurement& measured, double periods, JudgedInputs& in) noexcept {
  if (CalmPressures::Four now; periods == 1.0 && calm_.take(measured.channel, judged_, now)) {
    in.port_Pa = {now[0], now[1]};
    in.chamber_Pa = {now[2], now[3]};
    return 0;
  }
  calm_.leave(guards_);
  std::uint64_t faults = 0;
  const double x = std::isfinite(in.position_m) ? in.position_m : 0.0;
  const auto wave_Pa = [&]() noexcept { return port_step_Pa_per_V_ * activity_V_; };
  in.chamber_Pa[1] = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < (has_slider_ ? 2 : 1); ++i) {
    const Signal port = port_signals[i], chamber = chamber_signals[i];
    const auto step_Pa = [&]() noexcept {
      return i == 0 ? chamber_step_Pa(cylinder_.dead_volume_1_m3, cylinder_.area_1_m2, half_stroke_m_ + x)
                    : chamber_step_Pa(cylinder_.dead_volume_2_m3, cylinder_.area_2_m2, half_stroke_m_ - x);
    };
    in.port_Pa[i] = judge_channel(port, measured.channel[port], periods, wave_Pa, faults);
    judged_[chamber] = judged_[chamber] || needs_chambers_ || measured.channel[chamber].origin != Origin::absent;
    in.chamber_Pa[i] = judged_[chamber] ? judge_channel(chamber, measured.channel[chamber], periods, step_Pa, faults)
                                        : std::numeric_limits<double>::quiet_NaN();
    if (in.port_Pa[i] > pressure_limit_Pa_ || in.chamber_Pa[i] > pressure_limit_Pa_) faults |= fault_pressure_limit;
  }
  calm_.begin(guards_, judged_);
  return faults;
}

std::uint64_t Supervisor::judge_losses(const Measurement& measured, double periods, JudgedInputs& in) noexcept {
  std::uint64_t faults = 0;
  for (std::size_t i = 0; i < difference_signals.size(); ++i) {
    const Signal signal = difference_signals[i];
    const Channel& channel = measured.channel[signal];
    judged_[signal] = judged_[signal] || needs_losses_ || channel.origin != Origin::absent;
    if (!judged_[signal]) continue;
    const double loss_Pa = judge_channel(signal, channel, periods, no_extra, faults);
    if (std::fabs(loss_Pa) < loss_range_Pa_) in.loss_Pa[i] = sensors_.of(signal, loss_Pa);
  }
  return faults;
}

std::uint64_t Supervisor::judge_supply(const Channel& supply, double periods, JudgedInputs& in) noexcept {
  in.supply_Pa = supply_Pa_;
  judged_[Signal::p_supply] = judged_[Signal::p_supply] || supply.origin != Origin::absent;
  if (!judged_[Signal::p_supply]) return 0;
  std::uint64_t faults = 0;
  const double value = judge_channel(Signal::p_supply, supply, periods, no_extra, faults);
  if (!std::isfinite(value)) return faults;
  in.supply_Pa = value;
  if (value < supply_limit_Pa_) faults |= fault_supply_low;
  return faults;
}

// A line that cannot be read counts as the worse of its states. A limit switch ends the motion when the slider comes
// onto it, not while it stands there: otherwise no motion could lead off it.
std::uint64_t Supervisor::judge_digital(const DigitalInputs& digital) noexcept {
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

bool Supervisor::inputs_ready() const noexcept {
  if (all_good_) return true;
  for (const Signal signal : channel_signals)
    if (judged_[signal] && guards_[signal].waiting()) return false;
  return true;
}

PerSignal<bool> Supervisor::bad_samples() const noexcept {
  PerSignal<bool> bad;
  for (const Signal signal : channel_signals) bad[signal] = judged_[signal] && guards_[signal].bad();
  return bad;
}

JudgedInputs Supervisor::judge(const Measurement& measured, std::int64_t skipped) noexcept {
  if (!sensors_.corrects()) [[likely]]
    return judge_corrected(measured, skipped);
  Measurement known = measured;
  sensors_.correct_absolute(known.channel);
  return judge_corrected(known, skipped);
}

JudgedInputs Supervisor::judge_corrected(const Measurement& measured, std::int64_t skipped) noexcept {
  JudgedInputs in;
  const double periods = static_cast<double>(skipped + 1);
  bridged_ = false;
  all_good_ = true;
  std::uint64_t faults = has_slider_ ? judge_position(measured.channel[Signal::x], periods, in) : 0;
  faults |= judge_pressures(measured, periods, in);
  if (!has_slider_) in.port_Pa[1] = in.port_Pa[0];
  if (has_losses_) faults |= judge_losses(measured, periods, in);
  faults |= judge_supply(measured.channel[Signal::p_supply], periods, in);
  // What a dead bus does not bring is its consequence, not the reason.
  if ((measured.device_faults & (device_bus_off | device_link_down)) != 0) faults &= ~missing_faults;
  // After a fault the heartbeat is withheld: devices whose watchdog acted send nothing more.
  if (on_bus_ && state_ == SupervisorState::fault) faults &= ~missing_faults;
  faults |= judge_digital(measured.digital);
  faults |= faults_of_devices(measured.device_faults);
  // Slots are skipped where lateness and work together passed the next one of the ideal grid.
  if (static_cast<double>(skipped) * period_s_ > lateness_limit_s_) faults |= fault_late_tick;
  // After a fault the shares say nothing new.
  if (const std::uint64_t health = health_.check_tick(all_good_ ? PerSignal<bool>{} : bad_samples(), skipped);
      is_active() && faults == 0)
    faults = health;
  latch(faults);
  if (may_move_ && inputs_ready()) go(SupervisorEvent::inputs_ready);
  has_moved_ = has_moved_ || is_active();
  return in;
}

void Supervisor::cross_check(const JudgedInputs& inputs, const EstimatorOutput& estimate,
                             std::int64_t skipped) noexcept {
  if (!is_active()) return;
  // What the law acts on is watched; elsewhere a chamber's own sensor comes first.
  const std::array<double, 2> chamber_Pa = !has_losses_    ? inputs.chamber_Pa
                                           : needs_losses_ ? inputs.port_less_loss_Pa(inputs.chamber_Pa)
                                                           : inputs.known_chamber_Pa();
  const std::uint64_t found =
      cross_check_.check({command_V_, inputs.port_Pa, chamber_Pa, inputs.supply_Pa}, estimate, skipped);
  latch(has_slider_ ? found : found & ~second_side_faults);
  if (is_active()) latch(health_.check_rest(cross_check_.watching(), inputs.position_m, skipped));
}

void Supervisor::check_motion(const MotionCheck& motion) noexcept {
  std::uint64_t faults = motion_.check(motion.motion);
  const auto equal_ticks = guards_[Signal::x].equal_ticks();
  if (equal_ticks == 0) standstill_predicted_m_ = motion.motion.predicted_m;
  const bool long_enough = equal_ticks * period_s_ >= standstill_s;
  const double way = std::fabs(motion.motion.predicted_m - standstill_predicted_m_);
  if (long_enough && way > 2.0 * half_stroke_m_ * standstill_share) faults |= fault_position_frozen;
  if (!motion.command_good) faults |= fault_command_not_finite;
  if (!motion.estimate_usable) faults |= fault_estimate_invalid;
  latch(faults);
}

// How much the commands have moved of late, from one tick to the next.
void Supervisor::note_commands(const std::array<double, 2>& command_V) noexcept {
  const double step_V = std::max(std::fabs(command_V[0] - command_V_[0]), std::fabs(command_V[1] - command_V_[1]));
  activity_V_ = std::max(step_V, activity_V_ * activity_decay_);
  command_V_ = command_V;
}

}  // namespace pneuservo
