// What a machine is: numbers in SI units, all that may be wrong with it among them, neutral unless set.
#pragma once

#include "tube.hpp"

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace proof {

constexpr double never = std::numeric_limits<double>::infinity();

struct ValveData {
  double command_max_V = 5.0, area_per_volt = 2.6e-6, area_max = 1.3e-5, critical_ratio = 0.35;
  double frequency_Hz = 0.0, damping = 0.7, lag_s = 0.0, delay_s = 0.0;
  double play_V = 0.0, dead_band_V = 0.0, offset_V = 0.0, neutral_leak_m2 = 0.0, exhaust_ratio = 1.0;
  double wave_share = 0.0, wave_V = 1.0;      // area curve: times 1 + share cos(2 pi s / wave)
  double sticks_V = 0.0;                      // the spool rests until the command is this far away
  double drift_per_s = 0.0;                   // of all areas, relative
  double silencer_m2 = 0.0;                   // both exhausts through one opening; 0: free
};

struct SupplyData {
  double pressure_Pa = 7e5, temperature_K = 293.0;
  double hose_m2 = 0.0, volume_m3 = 0.0;      // regulator, hose, volume at the valve; 0: stiff
  double swing_Pa = 0.0, swing_Hz = 1.0;
  double regulator_gap_Pa = 0.0;              // opens below and closes above by half of it
  double dip_Pa = 0.0, dip_every_s = 1.0, dip_lasts_s = 0.2;  // other consumers
};

struct SideData {
  TubeData tube;
  double piston_m2 = 1.2e-3, dead_m3 = 2e-5, heat_W_per_m2K = 50.0;
  double port_m3 = 0.0;                       // volume at the valve port, where its sensor sits
  double inlet_loss = 0.0;                    // dynamic heads lost where gas leaves the chamber into the tube
  double end_m2 = never;                      // restriction between tube and chamber
  double out_of_chamber_m2 = never;           // the same, one way only (a check valve past it)
  double kink_m2 = never, kink_from_m = never;  // restriction beyond a position
  double cushion_m2 = never, cushion_m = 0.0; // outflow near this side's end stop
  double leak_m2 = 0.0;
  double relief_Pa = never, relief_m2_per_Pa = 0.0;
};

struct MotionData {
  double mass_kg = 2.0, viscous = 60.0, stroke_m = 0.3, restitution = 0.3;
  double forward_N = 0.0, backward_N = 0.0;   // dry friction by direction
  double extra_N = 0.0, stribeck_mps = 0.01;
  double seal_N_per_Pa = 0.0;
  double zone_N = 0.0, zone_at_m = 0.0, zone_m = 0.01;
  double drag = 0.0;
  double load_N = 0.0, spring_N_per_m = 0.0, spring_at_m = 0.0;
  double periodic_N = 0.0, periodic_Hz = 5.0;
  double bristle_N = 0.0, bristle_m = 4e-5;   // friction that the way builds up
  double warm_N = 0.0, warm_s = 5.0;          // extra dry friction that fades with time
  double bumper_N_per_m = 0.0, bumper_at_m = never;
  double gained_kg = 0.0, gained_at_s = never, gained_weight_N = 0.0;
  double blow_N = 0.0, blow_every_s = 1.0, blow_lasts_s = 0.05;
  double tail_kg = 0.0, tail_Hz = 20.0, tail_damping = 0.05;  // part of the mass on a spring
};

struct SensorData {
  double noise = 0.0, quantum = 0.0, offset = 0.0, gain = 1.0, lag_s = 0.0, play = 0.0, bend = 0.0;
};

struct MachineData {
  Gas gas;
  ValveData valve;
  SupplyData supply;
  std::array<SideData, 2> side;
  MotionData motion;
  double piston_leak_m2 = 0.0, piston_zone_m2 = 0.0, piston_zone_at_m = 0.0, piston_zone_m = 0.02;
  double room_K = 293.0;
};

}  // namespace proof
