// A recording made by the project's own plant in a simple loop, with sensors: its truth is known.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/sensor.hpp>
#include <pneuservo/rig/plant.hpp>
#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo::test {

inline Rig cylinder_rig(double length_m = 5.0, double diameter_m = 6.1e-3) {
  Rig rig;
  rig.name = "simulated";
  AxisParameters<double>& axis = rig.axis;
  axis.supply.pressure_Pa = 700e3;
  axis.valve = {5.0, 2.6e-6, 1.3e-5, 0.35};
  axis.line_1.length_m = axis.line_2.length_m = length_m;
  axis.line_1.diameter_m = axis.line_2.diameter_m = diameter_m;
  axis.cylinder = {0.3, 1.257e-3, 1.056e-3, 2e-5, 2e-5, 50.0};
  axis.slider.mass_kg = 2.0;
  axis.slider.viscous_friction_Ns_per_m = 60.0;
  rig.sensors.position.quantum_m = 5e-6;
  rig.sensors.port_pressure = rig.sensors.chamber_pressure = rig.sensors.supply_pressure = {100.0, 300.0};
  return rig;
}

/// The same with an owner who does not know most of his numbers to better than some percent.
inline Rig toleranced_cylinder_rig(double length_m, double diameter_m) {
  Rig rig = cylinder_rig(length_m, diameter_m);
  rig.tolerances = {{"slider.mass_kg", 0.02},
                    {"slider.viscous_friction_Ns_per_m", 0.1},
                    {"line_1.length_m", 0.005},
                    {"line_2.length_m", 0.005},
                    {"line_1.diameter_m", 0.01},
                    {"line_2.diameter_m", 0.01},
                    {"cylinder.dead_volume_1_m3", 0.05},
                    {"cylinder.dead_volume_2_m3", 0.05},
                    {"supply.pressure_Pa", 0.005},
                    {"valve.area_per_volt_m2_per_V", 0.03}};
  return rig;
}

/// Moves and rests under a position loop with force feedback, seconds long; channels as given.
inline Recording simulated_recording(const Rig& rig, double seconds, std::uint64_t seed,
                                     const std::vector<std::string>& channels) {
  AxisPlant<double> plant;
  plant.configure(rig.axis, rig.period_s, 25.0);
  plant.reset({0.0, 470e3, balancing_pressure_2(rig.axis, 470e3)});
  const std::array<PressureSensorParameters, 6> resolution{
      PressureSensorParameters{rig.sensors.position.quantum_m, rig.sensors.position.noise_m},
      rig.sensors.port_pressure,
      rig.sensors.port_pressure,
      rig.sensors.chamber_pressure,
      rig.sensors.chamber_pressure,
      rig.sensors.supply_pressure};
  std::array<Sensor, 6> sensors;
  const auto truth = [&]() -> std::array<double, 6> {
    const auto port = plant.port_pressure(), chamber = plant.chamber_pressure();
    return {plant.position(), low(port), high(port), low(chamber), high(chamber), plant.supply_pressure()};
  };
  for (std::size_t i = 0; i < 6; ++i) {
    sensors[i].configure(rig.sensor_effects[i], resolution[i].quantum_Pa, resolution[i].noise_Pa, rig.period_s,
                         Random(seed, i));
    sensors[i].reset(truth()[i]);
  }
  Recording recording;
  recording.path = "simulated";
  recording.period_s = rig.period_s;
  recording.names = {"t_s", "x_m", "u_V"};
  recording.names.insert(recording.names.end(), channels.begin(), channels.end());
  recording.values.resize(recording.names.size());
  const auto samples = static_cast<std::size_t>(seconds / rig.period_s);
  const std::size_t before = static_cast<std::size_t>(6.0 / rig.period_s);  // the axis has been held before
  double last_x = 0, speed = 0;
  for (std::size_t k = 0; k < before + samples; ++k) {
    std::array<double, 6> y{};
    for (std::size_t i = 0; i < 6; ++i) y[i] = sensors[i].read(truth()[i]);
    const double t = k < before ? 0.0 : static_cast<double>(k - before) * rig.period_s;
    const double in_move = std::fmod(t - 0.3, 3.2);  // there and back, then rest
    const double reference = t < 0.3 || in_move > 2.0944 ? 0.0 : 0.05 * (std::cos(3.0 * in_move) - 1.0);
    speed += 0.25 * ((y[0] - last_x) / rig.period_s - speed);
    last_x = y[0];
    const double force =
        rig.axis.cylinder.area_1_m2 * (y[3] - 101325.0) - rig.axis.cylinder.area_2_m2 * (y[4] - 101325.0);
    const double u = std::round((0.004 * (8000.0 * (reference - y[0]) - 150.0 * speed - force)) / 2.5e-4) * 2.5e-4;
    const double command = std::clamp(u, -5.0, 5.0);
    if (k >= before) {
      for (std::size_t c = 0; c < recording.names.size(); ++c) {
        double value = 0;
        if (recording.names[c] == "t_s") value = t;
        else if (recording.names[c] == "u_V") value = command;
        else
          for (std::size_t i = 0; i < 6; ++i)
            if (recording.names[c].starts_with(channel_names[i]) &&
                recording.names[c].size() <= channel_names[i].size() + 3)
              value = y[i];
        recording.values[c].push_back(value);
      }
      recording.line_numbers.push_back(k);
    }
    plant.step(command);
  }
  return recording;
}

inline const std::vector<std::string> all_pressures{"p1_port_Pa", "p2_port_Pa", "p1_chamber_Pa", "p2_chamber_Pa",
                                                    "p_supply_Pa"};

}  // namespace pneuservo::test
