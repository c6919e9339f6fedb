// Which pieces of long recordings are compared: those that together tell most of the machine.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "diagnosis/diagnosis.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// What is compared, each piece a recording of its own, and how it was chosen.
struct TellingPieces {
  std::vector<Recording> recordings;
  Coverage coverage;
};

/// Recordings of up to 30 s in all (of driven axes 300 s) come back as they are, and so do rigs that are simulated over
/// uneven rows. Of longer ones pieces of 6 s are taken one after the other, each the one that makes the determinant of
/// the information about a model in position, speed, acceleration, drive and time grow most (D-optimal). Held-out
/// recordings are treated alike, for themselves.
TellingPieces telling_pieces(const Rig& rig, std::vector<Recording> recordings);

}  // namespace pneuservo
