// Doubt before a search: recorded channels against what the rig can do, from ranges, units, noise and wiring.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// Judges every channel of cylinders and driven axes. What is certain is corrected in the recordings and told in
/// `notes` with its evidence and the key that states it: units, the zero of the position, an exchange or a reversal
/// that alone fits, the turns of a counter. Impossible, frozen and clipped samples are taken out. A sensor that is
/// coarser than the rig says becomes so in the rig. Throws InputError, one sentence with evidence and remedy, for what
/// has to be asked.
void doubt_recordings(Rig& rig, std::vector<Recording>& recordings, std::vector<std::string>& notes);

}  // namespace pneuservo
