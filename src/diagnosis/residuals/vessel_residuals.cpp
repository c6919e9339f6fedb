// A vessel behind an on/off valve, simulated along recordings.
#include "diagnosis/residuals/vessel_residuals.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <pneuservo/rig/vessel_plant.hpp>

#include "config/input_error.hpp"
#include "diagnosis/recordings/held_out.hpp"

namespace pneuservo {

namespace {

constexpr double steps_a_recording = 8000, longest_step_s = 0.05, line_period_s = 1e-3;
constexpr double fitted_share = 2.0 / 3.0;
constexpr double supply_sigma = 0.03;  ///< of a supply that was set, not measured
constexpr double steps_after_event = 10;  ///< of rows: later the first row does not see what the event found
constexpr std::size_t start_samples = 3;  ///< whose mean the simulation starts from, if they are within 1 s

double reading(const SensorEffects<double>& sensor, double truth) {
  return sensor.sensor_gain.gain * truth + sensor.sensor_offset.offset;
}

}  // namespace

double VesselResiduals::start_factor_sigma() const {
  const bool any_fills = std::any_of(inputs_.begin(), inputs_.end(), [](const Inputs& i) { return i.fills; });
  return any_fills ? supply_sigma : SampledResiduals::start_factor_sigma();
}

VesselResiduals::VesselResiduals(const Rig& rig, const std::vector<Recording>& recordings, int jobs) {
  std::vector<ResidualChannel> channels{{std::string(info(Signal::p1_chamber).name), "Pa",
                                         rig.sensors.chamber_pressure.rms_Pa(), rig.model_error.pressure_Pa}};
  if (rig.line) {
    channels.push_back(channels.front());
    channels.back().name = info(Signal::p1_port).name;
  }
  const bool has_held_out = any_held_out(recordings);
  std::vector<SampledRecording> prepared;
  for (const Recording& recording : recordings) {
    recording.require({"p1_chamber_Pa"});
    inputs_.push_back(inputs_of(rig, recording));
    SampledRecording out;
    out.time_s = recording.t_s();
    if (out.time_s.size() < 10)
      throw InputError(
          fmt::format("{}: found {} rows, expected at least 10 to compare", recording.path, out.time_s.size()));
    for (const ResidualChannel& channel : channels)
      out.measured.push_back(recording.has(channel.name + "_Pa") ? recording.column(channel.name + "_Pa")
                                                                 : std::vector<double>{});
    out.position_m.assign(out.time_s.size(), 0.0);
    out.velocity_mps = out.position_m;
    const double split = out.time_s.front() + fitted_share * (out.time_s.back() - out.time_s.front());
    for (const double t : out.time_s) {
      out.command.push_back(inputs_.back().program.at(t));
      out.held_out.push_back(has_held_out ? recording.is_held_out : t > split);
    }
    prepared.push_back(std::move(out));
  }
  declare(std::move(channels), std::move(prepared), jobs);
}

VesselResiduals::Inputs VesselResiduals::inputs_of(const Rig& rig, const Recording& recording) const {
  Inputs inputs{.program = command_program(rig, recording)};
  const std::vector<double>&t = recording.t_s(), &p = recording.column("p1_chamber_Pa");
  if (recording.has("p_supply_Pa")) {
    for (const double value : recording.column("p_supply_Pa"))
      inputs.supply_Pa += value / static_cast<double>(t.size());
  }
  const double first_command = inputs.program.commands.front(), event_s = inputs.program.times_s.front();
  inputs.fills = first_command > 0;
  inputs.begin_s = t.front();
  if (first_command != 0.0 && t.front() > event_s && t.front() - event_s < steps_after_event * median_step_s(t)) {
    // Logged from an event at t = 0 on: what was there before it is the other end of the step.
    inputs.begin_s = event_s;
    inputs.start_Pa = first_command > 0 ? rig.axis.air.atmosphere_Pa : inputs.supply_Pa;
  }
  if (inputs.start_Pa == 0.0) {
    std::size_t count = 0;
    while (count < std::min(start_samples, t.size()) && t[count] - t.front() < 1.0) inputs.start_Pa += p[count++];
    inputs.start_Pa /= static_cast<double>(count);
  }
  return inputs;
}

std::vector<std::vector<double>> VesselResiduals::simulated(const Hypothesis& hypothesis, std::size_t r) const {
  const Rig& rig = hypothesis.rig;
  const Inputs& inputs = inputs_[r];
  const std::vector<double>& times = recordings()[r].time_s;
  const double factor = 1.0 + (2 * r < hypothesis.start_factors.size() ? hypothesis.start_factors[2 * r] : 0.0);
  const double stated_Pa = inputs.supply_Pa > 0 ? inputs.supply_Pa : rig.axis.supply.pressure_Pa;
  const double supply_Pa = inputs.fills ? stated_Pa * factor : stated_Pa;
  const double span = times.back() - times.front();
  const double longest = rig.line ? line_period_s : std::min(longest_step_s, span / steps_a_recording);
  const VesselEffects<double>& late = rig.vessel_effects;
  CommandProgram program = carried_out(inputs.program, 0, late.command_delay.delay_s, late.drop_out_delay.delay_s);
  double now = inputs.begin_s;
  program.times_s.insert(program.times_s.begin(), std::min(now, program.times_s.front()) - 1.0);
  program.commands.insert(program.commands.begin(), 0.0);  // closed before the first

  // What is emptied first stood under its pressure before; what was closed under it was charged just now.
  VesselPlant plant(rig, inputs.fills ? inputs.start_Pa : inputs.start_Pa * factor,
                    inputs.program.commands.front() < 0);
  std::vector<std::vector<double>> out(rig.line ? 2 : 1);
  for (const double t : times) {
    look();
    while (now < t - 1e-12) {
      const double h = std::min(longest, program.next_change_s(now + 1e-9, t) - now);
      plant.step(h, program.at(now + 1e-9), supply_Pa);
      now += h;
    }
    out[0].push_back(reading(rig.sensor_effects[Signal::p1_chamber], plant.chamber_Pa()));
    if (rig.line) out[1].push_back(reading(rig.sensor_effects[Signal::p1_port], plant.port_Pa()));
  }
  return out;
}

}  // namespace pneuservo
