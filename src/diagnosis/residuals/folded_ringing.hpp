// Ringing of a line at the sampling rate, which sampling folds down to slow changes of the port pressures.
#pragma once
#include "diagnosis/residuals/imposed_run.hpp"

namespace pneuservo {

/// At each sample of both ports [Pa]; empty where the line is too short to ring.
struct PossibleCourse {
  std::array<std::vector<double>, 2> ringing;   ///< the part that sampling folds down
  std::array<std::vector<double>, 2> pressure;  ///< all of it, true value
};
/// One for each length that was tried.
using PossibleRinging = std::vector<PossibleCourse>;

/// A held command is a staircase. A line with a mode near the sampling rate (2 m of pipe have one every 86 Hz) rings
/// with every stair alike while little gas flows and friction sleeps: by up to 1 kPa, which sampling once a stair
/// shows as a change over 60 ms. Whether a mode lies there, a quarter of a per cent of length decides, and no
/// affordable grid has it where the machine has it. So what it may make of a port's pressure is an error of the model.
///
/// Four lengths, up to 1.5 tolerances to both sides, are simulated along the recording (3.5 kB a sample meanwhile).
/// Within each period a parabola, the command's stair and sines of the sampling rate and twice it are fitted to a
/// port's pressure; the sines' value at the period's end is the ringing. No courses where the command's stairs are
/// slower than 2 ms (they ring with modes that every grid carries), or where sound crosses both lines within a stair.
PossibleRinging possible_ringing(const ImposedInputs& inputs, const Rig& owner, const PlantGrid& grid,
                                 const StopQuestion& stop = {});

}  // namespace pneuservo
