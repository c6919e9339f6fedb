// A vessel behind an on/off valve, simulated along recordings.
#include "diagnosis/vessel_residuals.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <pneuservo/elements/line_with_chamber.hpp>

#include "config/input_error.hpp"
#include "diagnosis/held_out.hpp"

namespace pneuservo {

namespace {

constexpr double steps_a_recording = 8000, longest_step_s = 0.05, line_period_s = 1e-3;
constexpr double cells_per_m = 4.0;
constexpr std::size_t port_sensor = 1, chamber_sensor = 3;
constexpr double fitted_share = 2.0 / 3.0;
constexpr std::size_t start_samples = 3;  ///< whose mean the simulation starts from, if they are within 1 s

double reading(const SensorEffects<double>& sensor, double truth) {
  return sensor.sensor_gain.gain * truth + sensor.sensor_offset.offset;
}

/// A chamber that does not move: wall of 1 m2, so that the conductance is the coefficient.
ChamberGeometry<double> geometry_of(const Rig& rig, double gas_kg, const Air<double>& air) {
  const ChargingHeat<double>& charging = rig.vessel_effects.charging_heat;
  double conductance = rig.vessel.wall_heat_W_per_K + rig.vessel_effects.wall_heat_exchange.conductance_W_per_K;
  if (charging.excess_K != 0.0) conductance += gas_kg * air.cv / charging.time_constant_s;
  return {0.5, rig.vessel.volume_m3, conductance};
}

/// Both kinds of vessel behind one face: the valve at the vessel itself, or at the other end of a line.
class VesselSimulation {
 public:
  VesselSimulation(const Rig& rig, double start_Pa) : rig_(rig), air_(rig.axis.air) {
    temperature_K_ = rig.vessel.gas_temperature_K + rig.vessel_effects.charging_heat.excess_K;
    const double gas_kg = start_Pa * rig.vessel.volume_m3 / (air_.R * temperature_K_);
    const ChamberGeometry<double> geometry = geometry_of(rig, gas_kg, air_);
    if (rig.line) {
      side_.configure(*rig.line, geometry, rig.axis.air,
                      std::max(4, static_cast<int>(std::lround(cells_per_m * rig.line->length_m))));
      side_.reset(start_Pa, temperature_K_, 0.0);
    } else {
      chamber_.configure(geometry, air_);
      chamber_.reset(start_Pa, temperature_K_, 0.0);
    }
  }
  /// Goes on by h with the areas open to supply and to exhaust.
  void step(double h, double command, double supply_Pa) {
    const double supply_area = command > 0 ? rig_.on_off_valve.supply_area_m2 : 0.0;
    const double exhaust_area = command < 0 ? rig_.on_off_valve.exhaust_area_m2 : 0.0;
    const double b = rig_.on_off_valve.critical_pressure_ratio;
    if (rig_.line) {
      const int substeps = side_.begin_period(h);
      for (int i = 0; i < substeps; ++i)
        side_.step_valve({supply_area, exhaust_area, supply_Pa, b}, 0.0, leak(side_.chamber()));
      return;
    }
    ChamberInflow<double> flow = leak(chamber_);
    const double p = chamber_.pressure(), T = chamber_.temperature();
    const double in = orifice_mass_flow(air_, supply_area, b, supply_Pa, air_.temperature_K, p, T);
    const double out = orifice_mass_flow(air_, exhaust_area, b, p, T, air_.atmosphere_Pa, air_.temperature_K);
    flow.mass_flow_kgps += in - out;
    flow.enthalpy_flow_W += orifice_enthalpy_flow(air_, in, air_.temperature_K, T) -
                            orifice_enthalpy_flow(air_, out, T, air_.temperature_K);
    chamber_.step(h, flow, 0.0);
  }
  double chamber_Pa() const { return rig_.line ? side_.chamber().pressure() : chamber_.pressure(); }
  double port_Pa() const { return rig_.line ? side_.port_pressure() : chamber_.pressure(); }

 private:
  ChamberInflow<double> leak(const Chamber<double>& chamber) const {
    const double flow = vessel_leak_flow(rig_.vessel_effects, air_, rig_.on_off_valve.critical_pressure_ratio,
                                         chamber.pressure(), chamber.temperature());
    return {-flow, -orifice_enthalpy_flow(air_, flow, chamber.temperature(), air_.temperature_K)};
  }

  const Rig& rig_;
  Air<double> air_;
  double temperature_K_;
  LineWithChamber<double> side_;
  Chamber<double> chamber_;
};

}  // namespace

VesselResiduals::VesselResiduals(const Rig& rig, const std::vector<Recording>& recordings, int jobs) {
  std::vector<ResidualChannel> channels{
      {"p1_chamber", "Pa", rig.sensors.chamber_pressure.rms_Pa(), rig.model_error.pressure_Pa}};
  if (rig.line) {
    channels.push_back(channels.front());
    channels.back().name = "p1_port";
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
      out.command.push_back(command_at(inputs_.back().switch_s, inputs_.back().commands, t));
      out.held_out.push_back(has_held_out ? recording.is_held_out : t > split);
    }
    prepared.push_back(std::move(out));
  }
  declare(std::move(channels), std::move(prepared), jobs);
}

VesselResiduals::Inputs VesselResiduals::inputs_of(const Rig& rig, const Recording& recording) const {
  Inputs inputs;
  const std::vector<double>&t = recording.t_s(), &p = recording.column("p1_chamber_Pa");
  if (recording.has("u_V")) {
    const std::vector<double>& u = recording.column("u_V");
    inputs.switch_s = {std::min(t.front(), 0.0)};
    inputs.commands = {u.front()};
    for (std::size_t k = 1; k < t.size(); ++k)
      if (u[k] != u[k - 1]) inputs.switch_s.push_back(t[k]), inputs.commands.push_back(u[k]);
  } else {
    for (const double time_s : rig.program.times_s) inputs.switch_s.push_back(t.front() + time_s);
    inputs.commands = rig.program.commands;
  }
  if (recording.has("p_supply_Pa")) {
    for (const double value : recording.column("p_supply_Pa"))
      inputs.supply_Pa += value / static_cast<double>(t.size());
  }
  if (inputs.commands.front() != 0.0 && t.front() > inputs.switch_s.front()) {
    // Logged from an event at t = 0 on: what was there before it is the other end of the step.
    inputs.start_Pa = inputs.commands.front() > 0 ? rig.axis.air.atmosphere_Pa : inputs.supply_Pa;
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
  const double supply_Pa = inputs.supply_Pa > 0 ? inputs.supply_Pa : rig.axis.supply.pressure_Pa;
  const double span = times.back() - times.front();
  const double longest = rig.line ? line_period_s : std::min(longest_step_s, span / steps_a_recording);
  // When each command comes to act.
  const VesselEffects<double>& late = rig.vessel_effects;
  std::vector<double> acts_s = inputs.switch_s;
  for (std::size_t i = 0; i < acts_s.size(); ++i)
    acts_s[i] += late.command_delay.delay_s + (inputs.commands[i] < 0 ? late.drop_out_delay.delay_s : 0.0);
  std::vector<double> values = inputs.commands;
  acts_s.insert(acts_s.begin(), std::min(times.front(), inputs.switch_s.front()) - 1.0);
  values.insert(values.begin(), 0.0);  // closed before the first

  VesselSimulation simulation(rig, inputs.start_Pa * factor);
  std::vector<std::vector<double>> out(rig.line ? 2 : 1);
  double now = std::min(times.front(), inputs.switch_s.front());
  for (const double t : times) {
    while (now < t - 1e-12) {
      const double command = command_at(acts_s, values, now + 1e-9);
      const auto next = std::upper_bound(acts_s.begin(), acts_s.end(), now + 1e-9);
      const double until = std::min(t, next == acts_s.end() ? t : *next);
      const double h = std::min(longest, until - now);
      simulation.step(h, command, supply_Pa);
      now += h;
    }
    out[0].push_back(reading(rig.sensor_effects[chamber_sensor], simulation.chamber_Pa()));
    if (rig.line) out[1].push_back(reading(rig.sensor_effects[port_sensor], simulation.port_Pa()));
  }
  return out;
}

}  // namespace pneuservo
