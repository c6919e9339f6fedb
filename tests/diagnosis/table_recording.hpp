// A recording of a servo table made by the project's own plant in a simple loop: two valves, each with its own command.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/sensor.hpp>
#include <pneuservo/rig/plant.hpp>

#include "config/read_rig.hpp"
#include "record/reader.hpp"

namespace pneuservo::test {

inline Rig table_rig() { return read_rig(PNEUSERVO_SOURCE_DIR "/config/servo-table-0.5m-4mm.yaml"); }

/// Swings of 40 mm under the printed law, the mean pressure held; position, both commands and both ports.
inline Recording table_recording(const Rig& rig, double seconds, std::uint64_t seed) {
  AxisPlant<double> plant;
  plant.configure(rig.axis, rig.period_s, 48.0, valve_arrangement(rig));
  constexpr double mean_Pa = 140e3, rate = 2.0, reach_m = 0.02;
  plant.reset({0.0, mean_Pa, mean_Pa});
  Sensor x_sensor;
  x_sensor.configure(rig.sensor_effects[Signal::x], rig.sensors.position.quantum_m, 0.0, rig.period_s, Random(seed, 0));
  x_sensor.reset(0.0);
  std::array<Sensor, 2> ports;
  for (std::size_t i = 0; i < 2; ++i) {
    const PressureSensorParameters& sensor = rig.sensors.port_pressure;
    ports[i].configure(rig.sensor_effects[port_signals[i]], sensor.quantum_Pa, sensor.noise_Pa, rig.period_s,
                       Random(seed, 1 + i));
    ports[i].reset(mean_Pa);
  }
  Recording recording;
  recording.path = "simulated table";
  recording.period_s = rig.period_s;
  recording.names = {"t_s", "x_m", "u1_V", "u2_V", "p1_port_Pa", "p2_port_Pa"};
  recording.values.resize(recording.names.size());
  const ControllerParameters& law = rig.controller;
  const auto samples = static_cast<std::size_t>(seconds / rig.period_s);
  for (std::size_t k = 0; k < samples; ++k) {
    const auto p = plant.port_pressure();
    const double t = static_cast<double>(k) * rig.period_s, phase = rate * std::max(0.0, t - 0.5);
    const double x = x_sensor.read(plant.position()), p_1 = ports[0].read(low(p)), p_2 = ports[1].read(high(p));
    const double error = reach_m * (1.0 - std::cos(phase)) - x;
    const double speed_error = reach_m * rate * std::sin(phase) - plant.velocity();
    const double acceleration_error = (phase > 0 ? reach_m * rate * rate * std::cos(phase) : 0.0) -
                                      plant.driving_force() / (rig.axis.slider.mass_kg + rig.axis.slider.payload_kg);
    const double u = law.of<Ppd2>().position_gain_V_per_m * error +
                     law.of<Ppd2>().velocity_gain_Vs_per_m * speed_error +
                     law.of<Ppd2>().acceleration_gain_Vs2_per_m * acceleration_error;
    const double u_mean = 1e-6 * (mean_Pa - 0.5 * (low(p) + high(p)));
    const auto limited = [&](double volts) {
      return std::clamp(volts, -rig.axis.valve.command_max_V, rig.axis.valve.command_max_V);
    };
    const std::array<double, 6> row{t, x, limited(u + u_mean), limited(-u + u_mean), p_1, p_2};
    for (std::size_t c = 0; c < row.size(); ++c) recording.values[c].push_back(row[c]);
    recording.line_numbers.push_back(k);
    plant.step(row[2], row[3]);
  }
  return recording;
}

}  // namespace pneuservo::test
