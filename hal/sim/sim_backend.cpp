// Backend `sim`.
#include "sim/sim_backend.hpp"

#include "config/rig_parameters.hpp"

namespace pneuservo {
namespace {

std::array<double, 6> true_values(const AxisPlant<double>& plant) noexcept {
  const auto port = plant.port_pressure(), chamber = plant.chamber_pressure();
  return {plant.position(), low(port), high(port), low(chamber), high(chamber), plant.supply_pressure()};
}

}  // namespace

PlantStart<double> plant_start(const Rig& rig) {
  const InitialParameters& start = rig.initial;
  return {start.position_m, start.pressure_1_Pa,
          start.pressure_2_Pa.value_or(balancing_pressure_2(rig.axis, start.pressure_1_Pa))};
}

SimBackend::SimBackend(const Rig& rig, Has sensors) : rig_(simulated_rig(rig)) {
  if (sensors == Has::every_sensor) return;
  is_there_[3] = is_there_[4] = rig.controller.takes_chambers() || rig.sensors.chamber_pressure.rms_Pa() > 0.0;
  is_there_[5] = rig.sensors.supply_pressure.rms_Pa() > 0.0;
}

void SimBackend::configure() {
  plant_.configure(rig_.axis, rig_.period_s, rig_.simulation.cells_per_m, valve_arrangement(rig_));
  plant_.reset(plant_start(rig_));
  const SensorsParameters& s = rig_.sensors;
  const std::array<double, 6> quantum{s.position.quantum_m,          s.port_pressure.quantum_Pa,
                                      s.port_pressure.quantum_Pa,    s.chamber_pressure.quantum_Pa,
                                      s.chamber_pressure.quantum_Pa, s.supply_pressure.quantum_Pa};
  const std::array<double, 6> noise{s.position.noise_m,          s.port_pressure.noise_Pa,
                                    s.port_pressure.noise_Pa,    s.chamber_pressure.noise_Pa,
                                    s.chamber_pressure.noise_Pa, s.supply_pressure.noise_Pa};
  const auto values = true_values(plant_);
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    sensors_[i].configure(rig_.sensor_effects[i], quantum[i], noise[i], rig_.period_s, Random(rig_.seed, i));
    sensors_[i].reset(values[i]);
  }
  command_ = {};
  started_ = false;
  last_tick_ = -1;
}

void SimBackend::activate() { safe_output_ = {.has_outputs = true, .is_simulated = true}; }

bool SimBackend::read(std::int64_t tick, Measurement& measurement) noexcept {
  if (!started_) plant_tick_ = tick;
  started_ = true;
  for (; plant_tick_ < tick; ++plant_tick_) plant_.step(command_.valve_V, command_.valve_2_V);
  const auto values = true_values(plant_);
  const auto channels = channels_of(measurement);
  for (std::size_t i = 0; i < 6; ++i)
    if (is_there_[i]) *channels[i] = {sensors_[i].read(values[i]), 0.0, true, Origin::simulated};
  if (rig_.simulation.input_age_periods > 0) age_by_a_tick(tick, measurement);
  return true;
}

// Over a bus a tick finds what was sampled at the one before; the first tick finds what has been there for ever.
void SimBackend::age_by_a_tick(std::int64_t tick, Measurement& measurement) noexcept {
  const Measurement sampled = measurement;
  if (last_tick_ >= 0) {
    measurement = last_;
    for (Channel* channel : channels_of(measurement))
      channel->age_s = static_cast<double>(tick - last_tick_) * rig_.period_s;
  }
  last_ = sampled;
  last_tick_ = tick;
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
  for (std::size_t i = 0; i < 6; ++i) all.channels[i] = is_there_[i] ? Origin::simulated : Origin::absent;
  return all;
}

Truth SimBackend::truth() const noexcept {
  const auto chamber = plant_.chamber_pressure();
  return {plant_.position(), low(chamber), high(chamber)};
}

}  // namespace pneuservo
