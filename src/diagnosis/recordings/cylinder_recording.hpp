// A recording of a pneumatic cylinder made ready for comparison: even samples, imposed inputs, noise of each channel.
#pragma once
#include <array>
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "diagnosis/recordings/held_out.hpp"
#include "diagnosis/recordings/recorded_rigs.hpp"
#include "diagnosis/residuals/imposed_run.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// Times within a recording that the comparison treats in a way of its own [s].
inline constexpr double ports_followed_s = 0.3;  ///< the gas finds its state after the measured port pressures
inline constexpr double first_compared_s = 0.35;

struct CylinderRecording {
  double start_s = 0.0;                        ///< t_s of sample 0
  ImposedInputs inputs;
  std::vector<double> position_m;              ///< as measured; NaN: no value
  PerSignal<std::vector<double>> measured;     ///< of gas_signals; empty: no such column; NaN: no value
  HeldOut held_out;
  MachineChanges changes;    ///< of the owner's rig while it was made
  std::vector<char> usable;  ///< may be compared: known inputs, and the gas has forgotten the start

  std::size_t samples() const { return position_m.size(); }
  double period_s() const { return inputs.period_s; }
  double time_s(std::size_t k) const { return start_s + period_s() * static_cast<double>(k); }
};

/// Samples are the recording's own interval apart; the plant is stepped by the loop's periods in it. At most the first
/// longest_s are taken. Throws InputError where position, command or any pressure of a side is
/// missing, or where less than a second is left to compare.
CylinderRecording prepare_recording(const Recording& recording, const Rig& rig, double longest_s);

}  // namespace pneuservo
