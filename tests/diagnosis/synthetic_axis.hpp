// Recordings of a driven axis made here: the slider of the elements under a stiff position controller.
#pragma once
#include <cmath>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/sensor.hpp>
#include <pneuservo/elements/slider.hpp>

#include "config/read_rig.hpp"
#include "config/rig_parameters.hpp"
#include "record/reader.hpp"

namespace pneuservo::testing {

inline Rig driven_axis_rig() {
  return parse_rig(R"(
format: pneuservo-rig/1
name: axis
rig: driven_axis
period_s: 0.001
slider:   {mass_kg: 8.0, payload_kg: 0.0, viscous_friction_Ns_per_m: 50.0, stroke_m: 0.6, force_max_N: 300.0}
sensors:
  position: {quantum_m: 1.0e-6, noise_m: 1.0e-6}
  force:    {quantum_N: 0.01, noise_N: 0.0}
controller: {kind: pd_force, position_gain_N_per_m: 18000.0, velocity_gain_Ns_per_m: 600.0, velocity_filter_s: 0.003}
reference: {kind: sine, amplitude_m: 0.12, frequency_Hz: 0.8}
tolerances:
  slider.mass_kg: 0.012
  slider.viscous_friction_Ns_per_m: 0.06
)",
                   "synthetic axis");
}

/// Twelve seconds of moves, creeps and rests of `machine`, with `extra_N(t, x, v)` pushing beside the drive.
template <class Extra>
Recording axis_recording(const Rig& machine, std::uint64_t seed, const Extra& extra_N, double duration_s = 12.0) {
  Slider<double> slider;
  slider.configure(machine.axis.slider, machine.axis.effects.motion, machine.axis.cylinder.stroke_m, 0.0);
  Sensor sensor;
  sensor.configure(machine.sensor_effects[Signal::x], machine.sensors.position.quantum_m,
                   machine.sensors.position.noise_m, machine.period_s, Random(seed));
  sensor.reset(0.0);
  Recording recording;
  recording.path = "synthetic";
  recording.period_s = machine.period_s;
  recording.names = {"t_s", "x_m", "F_N"};
  recording.values.resize(3);
  const int substeps = 20, rows = static_cast<int>(duration_s / machine.period_s);
  double last = 0, rate = 0;
  for (int row = 0; row < rows; ++row) {
    const double t = row * machine.period_s, lap = std::fmod(t, 4.0);
    double wanted = 0.1 * (1 - std::cos(2 * M_PI * lap / 2)) / 2;  // there and back, a rest, a creep and back
    if (lap > 2) wanted = lap < 2.4 ? 0 : 0.02 * (lap - 2.4) * (4 - lap) / 0.64;
    wanted *= std::min(t / 0.5, 1.0) * (std::fmod(t, 8.0) < 4 ? 1 : -0.8);
    const double x = sensor.read(slider.position());
    rate += ((x - last) / machine.period_s - rate) * machine.period_s / 0.004;
    last = x;
    const double force = quantise(18000 * (wanted - x) - 600 * rate, machine.sensors.force.quantum_N);
    recording.values[0].push_back(t);
    recording.values[1].push_back(x);
    recording.values[2].push_back(force);
    recording.line_numbers.push_back(static_cast<std::size_t>(row) + 2);
    for (int sub = 0; sub < substeps; ++sub)
      slider.step(machine.period_s / substeps, force + extra_N(t, slider.position(), slider.velocity()), {});
  }
  return recording;
}

inline double no_extra(double, double, double) { return 0.0; }

}  // namespace pneuservo::testing
