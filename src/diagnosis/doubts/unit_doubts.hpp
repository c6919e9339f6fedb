// Units and zeros of pressures, command and position as hypotheses: each reading fits the recording or does not.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// Readings that the channels' ranges leave open, or already decide: what fits is applied and told. Throws InputError
/// where no reading or more than one is possible.
void doubt_units(const Rig& rig, Recording& recording, std::vector<std::string>& notes);

}  // namespace pneuservo
