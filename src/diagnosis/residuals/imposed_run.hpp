// Valve, supply, lines and chambers of supposed rigs along one recording: its command, its motion and its supply are
// imposed, so that a wrong start is forgotten and no error of the gas can drive the slider away.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <pneuservo/rig/plant.hpp>
#include <pneuservo/rig/rig.hpp>

#include "diagnosis/stop.hpp"

namespace pneuservo {

/// What is imposed; all vectors have one entry a sample, period_s apart.
struct ImposedInputs {
  double period_s = 1e-3;
  int steps = 1;  ///< periods of the loop in one of the recording: a logger may keep every n-th row
  /// From its sample to the next; of several steps, changing evenly from one to the next unless it is held. Of the
  /// valve of both sides, or of each side's own.
  std::array<std::vector<double>, 2> command_V;
  bool command_is_held = true;
  /// Samples from one recorded command to the next, and the first of them: a logger may write it in every n-th row.
  std::size_t command_samples = 1, first_command = 0;
  /// Beside them at every step of every sample, of both sides' valves; empty: none.
  std::array<std::vector<double>, 2> quick_command_V{};
  std::vector<double> position_m, velocity_mps;       ///< as measured, smoothed
  std::array<std::vector<double>, 2> start_Pa;        ///< pressure at or near each port, as measured, smoothed
  std::array<std::vector<double>, 2> start_Pa_per_s;  ///< and its rate
  std::array<Signal, 2> start_sensor = port_signals;  ///< whose reading that is
  std::size_t release = 0;                            ///< samples in which the gas follows these pressures
  /// What the valves find, as measured, smoothed, and its rate; empty where nothing measures it.
  std::vector<double> supply_Pa, supply_Pa_per_s;
  std::vector<Signal> wanted{gas_signals.begin(), gas_signals.end()};  ///< what courses hold

  double step_s() const { return period_s / steps; }
  std::size_t samples() const { return command_V[0].size(); }
  bool has_two_valves() const { return !command_V[1].empty(); }
  /// What moves the spool that feeds this side.
  const std::vector<double>& command_of(std::size_t side) const { return command_V[has_two_valves() ? side : 0]; }
  double command_at(std::size_t side, std::size_t k, int step) const;  ///< of sample k, step 0 to steps - 1
  double position_at(std::size_t k, int step) const;  ///< at the step's end; step = steps - 1 is sample k + 1
  double supply_at(std::size_t k, int step) const;    ///< in the middle of the step
};

/// Simulated gas_signals that are wanted at every sample, just before its command acts: true values, no sensor in them.
using GasCourse = PerSignal<std::vector<double>>;

/// One rig to simulate with the factors on its gas when it is left to itself.
struct ImposedRun {
  const Rig* rig = nullptr;
  std::array<double, 2> start_factor{};  ///< relative temperature minus 1 of sides 1 and 2
};

/// Rigs that run side by side in one call at most.
inline constexpr std::size_t imposed_lanes = 4;

/// Steps of the plant between two looks for a stop: one of the finest grid takes 0.1 ms.
inline constexpr int steps_between_looks = 100;

/// Simulates 1 to imposed_lanes rigs side by side on one grid; their results do not depend on each other. A rig whose
/// gas leaves all bounds ends with NaN. Throws DiagnosisStopped.
std::vector<GasCourse> run_imposed(const ImposedInputs& inputs, std::span<const ImposedRun> runs, const PlantGrid& grid,
                                   const StopQuestion& stop = {});

/// The finest grid, stable in time, whose cells times sub-steps stay within `work` a step and line. step_s: what the
/// plant is stepped by, which is the recording's and not the config's.
PlantGrid grid_for(const Rig& rig, double work, double step_s);

}  // namespace pneuservo
