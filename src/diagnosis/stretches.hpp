// Recordings cut where their inputs are missing: what lies behind a gap begins anew.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// The stretches that can be compared, each a recording of its own with its own start. A recording without gaps comes
/// back as it is. What is left out, and every cut, is told in `notes`. Rigs that are simulated over uneven rows are
/// not cut. Throws InputError where no stretch is long enough.
std::vector<Recording> compared_stretches(const Rig& rig, const std::vector<Recording>& recordings,
                                          std::vector<std::string>& notes);

}  // namespace pneuservo
