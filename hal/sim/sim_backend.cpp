// Backend `sim`.
#include "sim/sim_backend.hpp"

#include <algorithm>
#include <cmath>

#include "config/rig_parameters.hpp"

namespace pneuservo {
PlantStart<double> plant_start(const Rig& rig) {
  const InitialParameters& start = rig.initial;
  return {start.position_m, start.pressure_1_Pa,
          start.pressure_2_Pa.value_or(balancing_pressure_2(rig.axis, start.pressure_1_Pa))};
}

SimBackend::SimBackend(const Rig& rig, Has sensors) : rig_(simulated_rig(rig)) {
  for (const Signal signal : channel_signals) is_there_[signal] = rig.has_sensor(signal);
  if (sensors == Has::every_sensor) return;
  for (const Signal chamber : chamber_signals)
    is_there_[chamber] =
        is_there_[chamber] && (rig.controller.takes_chambers() || rig.sensors.chamber_pressure.rms_Pa() > 0.0);
  for (const Signal signal : {Signal::p_supply, Signal::supply_flow})
    is_there_[signal] = is_there_[signal] && rig.sensors.resolution(signal).rms() > 0.0;
}

void SimBackend::configure_plant() {
  drive_ticks_ = 0;
  auto axis = rig_.axis;
  if (const double period_s = rig_.simulation.valve_drive_period_s; period_s > 0.0) {
    drive_ticks_ = static_cast<int>(std::lround(rig_.period_s / period_s));
    ValveDriveParameters parameters{{}, axis.valve.command_max_V, rig_.simulation.spool_quantum_m};
    parameters.loop.natural_frequency_Hz = axis.valve.natural_frequency_Hz;
    parameters.loop.damping_ratio = axis.valve.damping_ratio;
    parameters.loop.period_s = period_s;
    for (ValveDrive& drive : drives_) drive.configure(parameters);
    axis.valve.natural_frequency_Hz = 0.0;  // the spool that the drive moved is where it is
  }
  plant_.configure(axis, drive_ticks_ > 0 ? rig_.period_s / drive_ticks_ : rig_.period_s, rig_.simulation.cells_per_m,
                   valve_arrangement(rig_));
}

void SimBackend::configure() {
  configure_plant();
  plant_.reset(plant_start(rig_));
  growth_.configure(rig_);
  const PerSignal<double> values = true_values(plant_);
  for (const Signal signal : channel_signals) {
    const auto [quantum, noise, range] = rig_.sensors.resolution(signal);
    sensors_[signal].configure(rig_.sensor_effects[signal], quantum, noise, rig_.period_s,
                               Random(rig_.seed, index_of(signal)), range);
    sensors_[signal].reset(values[signal]);
  }
  switches_random_ = Random(rig_.seed, signal_count);
  switches_on_ = {};
  switch_change_m_ = {rig_.position.low_m, rig_.position.high_m};
  command_ = {};
  started_ = false;
  last_tick_ = -1;
}

void SimBackend::activate() { safe_output_ = {.has_outputs = true, .is_simulated = true}; }

bool SimBackend::read(std::int64_t tick, Measurement& measurement) noexcept {
  if (!started_) plant_tick_ = tick;
  started_ = true;
  for (; plant_tick_ < tick; ++plant_tick_) step_plant();
  const PerSignal<double> values = true_values(plant_);
  for (const Signal signal : channel_signals)
    if (is_there_[signal])
      measurement.channel[signal] = {sensors_[signal].read(values[signal]), 0.0, true, Origin::simulated};
  if (rig_.position.has_switches()) show_switches(measurement.digital);
  if (rig_.simulation.input_age_periods > 0) age_by_a_tick(tick, measurement);
  return true;
}

void SimBackend::step_plant() noexcept {
  if (drive_ticks_ > 0) {
    const double most_V = rig_.axis.valve.command_max_V;
    for (int i = 0; i < drive_ticks_; ++i)
      plant_.step(drives_[0].step(std::clamp(command_.valve_V, -most_V, most_V)),
                  drives_[1].step(std::clamp(command_.valve_2_V, -most_V, most_V)));
    return;
  }
  if (!rig_.controls_pressure()) return plant_.step(command_.valve_V, command_.valve_2_V);
  step_pressure_plant(plant_, growth_, command_.valve_V);
}

// Over a bus a tick finds what was sampled at the one before; the first tick finds what has been there for ever.
void SimBackend::age_by_a_tick(std::int64_t tick, Measurement& measurement) noexcept {
  const Measurement sampled = measurement;
  if (last_tick_ >= 0) {
    measurement = last_;
    for (Channel& channel : measurement.channel.all)
      channel.age_s = static_cast<double>(tick - last_tick_) * rig_.period_s;
  }
  last_ = sampled;
  last_tick_ = tick;
}

// Each change draws anew where the next one will be, on below low_m or above high_m, off by the hysteresis nearer to
// the middle.
void SimBackend::show_switches(DigitalInputs& digital) noexcept {
  const PositionParameters& p = rig_.position;
  for (std::size_t i = 0; i < 2; ++i) {
    const double outwards = i == 0 ? -1.0 : 1.0, x_m = plant_.position();
    const bool on = outwards * (x_m - switch_change_m_[i]) > 0.0;
    if (on != switches_on_[i]) {
      const double on_m = i == 0 ? p.low_m : p.high_m, off_m = on_m - outwards * p.hysteresis_m;
      switch_change_m_[i] = (on ? off_m : on_m) + p.repeatability_m * switches_random_.normal();
      switches_on_[i] = on;
    }
    (i == 0 ? digital.switch_low : digital.switch_high).state = switches_on_[i] ? LineState::on : LineState::off;
  }
}

bool SimBackend::write(std::int64_t tick, const Command& command) noexcept {
  command_ = command;
  if (command.ended && safe_output_.sent_tick < 0) safe_output_.sent_tick = safe_output_.confirmed_tick = tick;
  return true;
}

void SimBackend::deactivate() noexcept {
  const auto safe_V = safe_commands_V(rig_);
  command_ = {safe_V[0], safe_V[1]};
}

Origins SimBackend::origins() const {
  Origins all{.command = Origin::simulated};
  if (rig_.position.has_switches()) all.lines[4] = all.lines[5] = Origin::simulated;
  for (const Signal signal : channel_signals)
    all.channels[signal] = is_there_[signal] ? Origin::simulated : Origin::absent;
  return all;
}

Truth SimBackend::truth() const noexcept {
  const auto chamber = plant_.chamber_pressure();
  if (rig_.controls_pressure()) return {.p1_chamber_Pa = low(chamber)};
  return {plant_.position(), low(chamber), high(chamber)};
}

}  // namespace pneuservo
