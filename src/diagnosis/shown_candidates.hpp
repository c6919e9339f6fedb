// Names that recordings cannot show are not tried.
#pragma once
#include <vector>

#include "diagnosis/candidates.hpp"

namespace pneuservo {

/// Without laws of the speed where there is one speed, laws of the direction and of the turn where the motion goes one
/// way, tight spots where each place is passed once, and charging heat where nothing has charged a vessel. What
/// friction has built up before a recording is not known: it shows where the motion turns.
std::vector<Candidate> shown_candidates(std::vector<Candidate> candidates, const Rig& rig, ResidualModel& model);

}  // namespace pneuservo
