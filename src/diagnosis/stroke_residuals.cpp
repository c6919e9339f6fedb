// A cylinder with an on/off valve, simulated along recordings of its strokes.
#include "diagnosis/stroke_residuals.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <pneuservo/elements/chamber.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/slider.hpp>

#include "config/input_error.hpp"
#include "diagnosis/held_out.hpp"

namespace pneuservo {

namespace {

constexpr double step_s = 2e-4;
constexpr double pattern_s = 0.2, fitted_of_pattern_s = 0.15;

/// Chambers, slider and cushions of one hypothesis.
class StrokeSimulation {
 public:
  StrokeSimulation(const Rig& rig, double position_m, double command) : rig_(rig), air_(rig.axis.air) {
    const CylinderParameters<double>& c = rig.axis.cylinder;
    half_stroke_m_ = 0.5 * c.stroke_m;
    chamber_1_.configure({c.area_1_m2, c.dead_volume_1_m3, c.wall_heat_W_per_m2K}, air_);
    chamber_2_.configure({c.area_2_m2, c.dead_volume_2_m3, c.wall_heat_W_per_m2K}, air_);
    slider_.configure(rig.axis.slider, rig.axis.effects.motion, c.stroke_m, 0.0);
    slider_.reset(std::clamp(position_m, -half_stroke_m_, half_stroke_m_), 0.0);
    const double filled = rig.axis.supply.pressure_Pa, empty = air_.atmosphere_Pa;
    chamber_1_.reset(command > 0 ? filled : empty, air_.temperature_K, half_stroke_m_ + slider_.position());
    chamber_2_.reset(command < 0 ? filled : empty, air_.temperature_K, half_stroke_m_ - slider_.position());
  }

  void step(double h, double command) {
    const CylinderParameters<double>& c = rig_.axis.cylinder;
    const AxisEffects<double>& effects = rig_.axis.effects;
    const double p1 = chamber_1_.pressure(), p2 = chamber_2_.pressure(), atmosphere = air_.atmosphere_Pa;
    ChamberInflow<double> in_1 = inflow(chamber_1_, rig_.throttle_1, command, effects.chamber_leak_1.area_m2);
    ChamberInflow<double> in_2 = inflow(chamber_2_, rig_.throttle_2, -command, effects.chamber_leak_2.area_m2);
    const double T1 = chamber_1_.temperature(), T2 = chamber_2_.temperature();
    const double across =
        orifice_mass_flow(air_, effects.piston_leak.area_m2, rig_.cylinder_critical_ratio, p1, T1, p2, T2);
    const double carried = orifice_enthalpy_flow(air_, across, T1, T2);
    in_1.mass_flow_kgps -= across, in_1.enthalpy_flow_W -= carried;
    in_2.mass_flow_kgps += across, in_2.enthalpy_flow_W += carried;
    const double drive = c.area_1_m2 * (p1 - atmosphere) - c.area_2_m2 * (p2 - atmosphere) - cushion_force(h);
    slider_.step(h, drive, {std::max(p1 - atmosphere, 0.0) + std::max(p2 - atmosphere, 0.0)});
    chamber_1_.step(h, in_1, half_stroke_m_ + slider_.position());
    chamber_2_.step(h, in_2, half_stroke_m_ - slider_.position());
  }
  double position_m() const { return slider_.position(); }

 private:
  /// From the supply (command above 0) or to atmosphere (below) through valve and flow control valve.
  ChamberInflow<double> inflow(const Chamber<double>& chamber, const ThrottleParameters& throttle, double command,
                               double leak_area) const {
    const double b = rig_.cylinder_critical_ratio, p = chamber.pressure(), T = chamber.temperature();
    const double T_air = air_.temperature_K, atmosphere = air_.atmosphere_Pa;
    const double in = orifice_mass_flow(air_, command > 0 ? throttle.inflow_area_m2 : 0.0, b,
                                        rig_.axis.supply.pressure_Pa, T_air, p, T);
    const double out =
        orifice_mass_flow(air_, (command < 0 ? throttle.outflow_area_m2 : 0.0) + leak_area, b, p, T, atmosphere, T_air);
    return {in - out, orifice_enthalpy_flow(air_, in, T_air, T) - orifice_enthalpy_flow(air_, out, T, T_air)};
  }
  /// At most what stops the slider within a step.
  double cushion_force(double h) const {
    const double x = slider_.position(), v = slider_.velocity(), most = slider_.mass() / h;
    if (v < 0 && x + half_stroke_m_ < rig_.cushion_1.length_m)
      return std::min(rig_.cushion_1.damping_Ns_per_m, most) * v;
    if (v > 0 && half_stroke_m_ - x < rig_.cushion_2.length_m)
      return std::min(rig_.cushion_2.damping_Ns_per_m, most) * v;
    return 0.0;
  }

  const Rig& rig_;
  Air<double> air_;
  double half_stroke_m_ = 0;
  Chamber<double> chamber_1_, chamber_2_;
  Slider<double> slider_;
};

}  // namespace

StrokeResiduals::StrokeResiduals(const Rig& rig, const std::vector<Recording>& recordings, int jobs) {
  const bool has_held_out = any_held_out(recordings);
  std::vector<SampledRecording> prepared;
  for (const Recording& recording : recordings) {
    recording.require({"x_m"});
    const std::vector<double>&t = recording.t_s(), &x = recording.column("x_m");
    if (t.back() - t.front() < 0.1)
      throw InputError(
          fmt::format("{}: found {:.3g} s, expected at least a stroke", recording.path, t.back() - t.front()));
    Program program;
    if (recording.has("u_V")) {
      const std::vector<double>& u = recording.column("u_V");
      for (std::size_t k = 0; k < t.size(); ++k)
        if (k == 0 || u[k] != u[k - 1]) program.times_s.push_back(t[k]), program.commands.push_back(u[k]);
    } else {
      for (const double time_s : rig.program.times_s) program.times_s.push_back(t.front() + time_s);
      program.commands = rig.program.commands;
    }
    SampledRecording out;
    out.time_s = t;
    out.measured = {x};
    for (std::size_t k = 0; k < t.size(); ++k) {
      const std::size_t before = k > 0 ? k - 1 : k, after = std::min(k + 1, t.size() - 1);
      out.position_m.push_back(x[k]);
      out.velocity_mps.push_back((x[after] - x[before]) / std::max(t[after] - t[before], 1e-9));
      out.command.push_back(command_at(program.times_s, program.commands, t[k]));
      out.held_out.push_back(has_held_out ? recording.is_held_out
                                          : std::fmod(t[k] - t.front(), pattern_s) >= fitted_of_pattern_s);
    }
    prepared.push_back(std::move(out));
    programs_.push_back(std::move(program));
  }
  declare({{"x", "m", rig.sensors.position.rms_m(), rig.model_error.position_m}}, std::move(prepared), jobs);
}

std::vector<std::vector<double>> StrokeResiduals::simulated(const Hypothesis& hypothesis, std::size_t r) const {
  const Rig& rig = hypothesis.rig;
  const SampledRecording& recording = recordings()[r];
  const SensorEffects<double>& sensor = rig.sensor_effects[0];
  std::vector<double> acts_s = programs_[r].times_s;
  for (std::size_t i = 1; i < acts_s.size(); ++i) acts_s[i] += rig.axis.effects.valve.command_delay.delay_s;
  StrokeSimulation simulation(rig, recording.position_m.front(), programs_[r].commands.front());
  std::vector<double> out;
  double now = recording.time_s.front(), shown = simulation.position_m();
  for (const double t : recording.time_s) {
    while (now < t - 1e-9) {
      const double h = std::min(step_s, t - now);
      simulation.step(h, command_at(acts_s, programs_[r].commands, now + 1e-9));
      now += h;
      shown += h / (sensor.sensor_lag.time_constant_s + h) * (simulation.position_m() - shown);
    }
    out.push_back(sensor.sensor_gain.gain * shown + sensor.sensor_offset.offset);
  }
  return {out};
}

}  // namespace pneuservo
