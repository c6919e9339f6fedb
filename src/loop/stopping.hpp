// How far and how long a rig goes on after a fault, and what stays in it: from the simulated loop, not from the
// machine.
#pragma once
#include <vector>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// One stop: the safe output begins at `at_s` of the course at speed_mps. Distances from there, without the reaction.
struct Stop {
  double at_s = 0.0;
  double speed_mps = 0.0;
  double distance_m = 0.0;    ///< furthest way from where the safe output began
  double standstill_s = 0.0;  ///< until the speed first was below 1 mm/s
  double rest_s = 0.0;        ///< until it stayed below 1 mm/s; infinite: longer than 1 s
  double further_m = 0.0;     ///< way between the turning points after the first standstill
  bool meets_end_stop = false;
};

/// The worst of all stops from at most this speed, over places on the stroke, directions, payloads and supplies.
struct StoppingRow {
  double speed_mps = 0.0;
  Stop worst;               ///< the furthest one
  double standstill_s = 0.0, rest_s = 0.0,
         further_m = 0.0;  ///< the largest of each, times from at least half the speed
};

/// Figures for the designer of a machine around the axis; all of the config's model.
struct StoppingTable {
  double top_speed_mps = 0.0;  ///< that the reference asks for
  double reaction_s = 0.0;     ///< from a cause at the inputs to the command at the valve, without detection
  Stop own_reference;          ///< the machine as configured at the top speed of the reference as configured
  std::vector<StoppingRow> rows;
  int moves = 0, moves_left_out = 0;  ///< about the three places; left out: the law cannot be planned for them
  double watchdog_s = 0.0;           ///< of the devices; 0: there is none
  double watchdog_distance_m = 0.0;  ///< the valve keeps its command so long before the safe output, from top speed
  double held_force_N = 0.0;    ///< largest force of the shut-in gas on a slider held where it was at the fault
  double stored_energy_J = 0.0; ///< largest work that the gas left in chambers and lines can do (isothermal)
  double vent_s = 0.0;  ///< until both chambers are below 1.1 times the atmosphere; infinite: never by itself
  double repressurising_speed_mps = 0.0;  ///< vented axis, valve fully open when the supply comes back
  double drop_s = 0.0,
         drop_speed_mps = 0.0;  ///< vertical axis whose carrying chamber loses its air: over half the stroke
};

/// Throws std::invalid_argument where the reference cannot be built (as AxisLoop::configure does).
StoppingTable stopping_table(const Rig& rig, const LoadPositions& load);

}  // namespace pneuservo
