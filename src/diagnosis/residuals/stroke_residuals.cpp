// A cylinder with an on/off valve, simulated along recordings of its strokes.
#include "diagnosis/residuals/stroke_residuals.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <pneuservo/rig/switched_cylinder_plant.hpp>

#include "config/input_error.hpp"
#include "diagnosis/recordings/held_out.hpp"

namespace pneuservo {

namespace {

constexpr double step_s = 2e-4;
constexpr double pattern_s = 0.2, fitted_of_pattern_s = 0.15;

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
    CommandProgram program = command_program(rig, recording);
    SampledRecording out;
    out.time_s = t;
    out.measured = {x};
    for (std::size_t k = 0; k < t.size(); ++k) {
      const std::size_t before = k > 0 ? k - 1 : k, after = std::min(k + 1, t.size() - 1);
      out.position_m.push_back(x[k]);
      out.velocity_mps.push_back((x[after] - x[before]) / std::max(t[after] - t[before], 1e-9));
      out.command.push_back(program.at(t[k]));
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
  const SensorEffects<double>& sensor = rig.sensor_effects[Signal::x];
  // The first command was given before the recording begins.
  const CommandProgram program = carried_out(programs_[r], 1, rig.axis.effects.valve.command_delay.delay_s);
  SwitchedCylinderPlant plant(rig, recording.position_m.front(), program.commands.front());
  std::vector<double> out;
  double now = recording.time_s.front(), shown = plant.position_m();
  for (const double t : recording.time_s) {
    look();
    while (now < t - 1e-9) {
      const double h = std::min(step_s, t - now);
      plant.step(h, program.at(now + 1e-9));
      now += h;
      shown += h / (sensor.sensor_lag.time_constant_s + h) * (plant.position_m() - shown);
    }
    out.push_back(sensor.sensor_gain.gain * shown + sensor.sensor_offset.offset);
  }
  return {out};
}

}  // namespace pneuservo
