// A recording made by the project's own plant in a simple loop, with sensors: its truth is known.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"
#include "sim/sim_backend.hpp"

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
  rig.sensors.supply_flow = {1e-6, 5e-6};  // a range of 200 Nl/min in 4000 steps
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

/// Moves and rests under a position loop with force feedback, seconds long; columns as given, beside time, position and
/// command. The rig's deviations are the machine's. pace: of the motion. force_gain_V_per_N: how much of the command is
/// the pressure sensors' noise; what it is not is the encoder's, through the filter of the speed.
inline Recording simulated_recording(Rig rig, double seconds, std::uint64_t seed,
                                     const std::vector<std::string>& channels, double pace = 1.0,
                                     double force_gain_V_per_N = 0.004) {
  rig.seed = seed;
  rig.simulation = {.cells_per_m = 25.0, .input_age_periods = 0};
  rig.initial = {};
  rig.initial.pressure_1_Pa = 470e3;
  SimBackend machine(rig);
  machine.configure();
  Recording recording;
  recording.path = "simulated";
  recording.period_s = rig.period_s;
  recording.names = {"t_s", "x_m", "u_V"};
  recording.names.insert(recording.names.end(), channels.begin(), channels.end());
  recording.values.resize(recording.names.size());
  const auto samples = static_cast<std::int64_t>(seconds / rig.period_s);
  const auto before = static_cast<std::int64_t>(6.0 / rig.period_s);  // the axis has been held before
  double last_x = 0, speed = 0;
  for (std::int64_t k = 0; k < before + samples; ++k) {
    Measurement measured;
    machine.read(k, measured);
    const auto y = [&](Signal signal) { return measured.channel[signal].value; };
    const double t = k < before ? 0.0 : static_cast<double>(k - before) * rig.period_s;
    const double in_move = std::fmod(pace * (t - 0.3), 3.2);  // there and back, then rest
    const double reference = t < 0.3 || in_move > 2.0944 ? 0.0 : 0.05 * (std::cos(3.0 * in_move) - 1.0);
    speed += 0.25 * ((y(Signal::x) - last_x) / rig.period_s - speed);
    last_x = y(Signal::x);
    const double force = rig.axis.cylinder.area_1_m2 * (y(Signal::p1_chamber) - 101325.0) -
                         rig.axis.cylinder.area_2_m2 * (y(Signal::p2_chamber) - 101325.0);
    const double u =
        std::round((force_gain_V_per_N * (8000.0 * (reference - y(Signal::x)) - 150.0 * speed - force)) / 2.5e-4) *
        2.5e-4;
    const double command = std::clamp(u, -5.0, 5.0);
    machine.write(k, {.valve_V = command});
    if (k < before) continue;
    for (std::size_t c = 0; c < recording.names.size(); ++c) {
      const auto signal = signal_of_column(recording.names[c]);
      recording.values[c].push_back(signal ? y(*signal) : recording.names[c] == "t_s" ? t : command);
    }
    recording.line_numbers.push_back(static_cast<std::size_t>(k));
  }
  return recording;
}

inline const std::vector<std::string> all_pressures{"p1_port_Pa", "p2_port_Pa", "p1_chamber_Pa", "p2_chamber_Pa",
                                                    "p_supply_Pa"};
inline const std::vector<std::string> all_of_the_gas{"p1_port_Pa",    "p2_port_Pa",  "p1_chamber_Pa",
                                                     "p2_chamber_Pa", "p_supply_Pa", "supply_flow_kgps"};

}  // namespace pneuservo::test
