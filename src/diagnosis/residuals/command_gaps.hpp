// What commands that a slow logger did not keep may do to the gas: an error of the model where rows are sparse.
#pragma once
#include "diagnosis/residuals/imposed_run.hpp"

namespace pneuservo {

/// True pressures [Pa] under the recorded commands less those under every second of them, the gaps drawn straight
/// alike. Of a noisy loop the commands that were never recorded leave as much open as those left out here; of smooth
/// ones a third, for the error of a straight gap grows with the square of its width. Empty where the rows hold every
/// command of the loop.
GasCourse command_gap_error(const ImposedInputs& inputs, const Rig& rig, const PlantGrid& grid,
                            const StopQuestion& stop = {});

/// The same of so many draws of commands between the recorded ones, as noisy as these are. How fast they change no row
/// tells: they have a part that changes at every step and one that is half a wave from row to row, to which the gas
/// answers most. A play or an overlap answers to the largest of them, so that its size is found too small.
std::vector<GasCourse> unseen_command_changes(const ImposedInputs& inputs, const Rig& rig, const PlantGrid& grid,
                                              std::size_t draws, const StopQuestion& stop = {});

/// Root mean square over the time that the model's error stays alike, around every sample.
std::vector<double> size_around(const std::vector<double>& error, double period_s);

}  // namespace pneuservo
