// A scenario: the machine, its sensors, its loop and its move, read from plain lines `key value...`.
#pragma once

#include "machine_data.hpp"

#include <cstdint>
#include <istream>
#include <utility>

namespace proof {

/// Where the slider shall be: rests, then waves under a smooth ramp, or smooth moves between points.
struct MoveData {
  double center_m = 0.0, start_s = 0.3, ramp_s = 1.0;
  std::vector<std::array<double, 3>> waves;            // amplitude m, frequency Hz, phase rad
  std::vector<std::pair<double, double>> points;       // time s, position m
};

/// A user's loop: force from position and speed, command from force; pressures from the ports or the chambers.
struct LoopData {
  double position_gain = 8000.0, speed_gain = 120.0, force_gain = 0.004, filter_s = 0.003, bias_N = 0.0,
         step_V = 2.5e-4;
  bool at_chambers = false;
};

struct Scenario {
  MachineData machine;
  std::array<SensorData, 6> sensors;  // position, ports 1 and 2, chambers 1 and 2, supply
  LoopData loop;
  MoveData move;
  double period_s = 1e-3, first_s = 4.0, length_s = 8.0, jitter_s = 0.0;
  double start_Pa = 4.7e5, start_2_Pa = 0.0;  // 0: what balances the piston
  double area_1_m2 = 0.0, area_2_m2 = 0.0;  // as the loop believes
  std::uint64_t seed = 1;
};

/// Throws std::runtime_error with the line where a key is unknown or a number is missing.
Scenario read_scenario(std::istream& in);

}  // namespace proof
