// Exchanged and reversed channels as hypotheses: each is one simulation that fits or does not.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// Ports exchanged, command or position reversed: the one that alone fits is corrected and told.
void doubt_wiring(const Rig& rig, Recording& recording, std::vector<std::string>& notes);
/// Whether another wiring of what is recorded leaves decisively less of the balances than as recorded, and less than
/// another reading does.
bool is_rather_rewired(const Rig& rig, const Recording& recording, const Recording& read_otherwise);
/// Whether the drive force of a driven axis was read at its rows' instants, unless that is stated: it then comes half a
/// period earlier than a held one.
void doubt_sampling(const Rig& rig, Recording& recording, std::vector<std::string>& notes);

/// Simulated under the recorded command and motion: root mean square difference from the measured pressures as a share
/// of how the ports vary; infinite where nothing can be simulated. At most the first seconds are taken.
double port_misfit(const Rig& rig, const Recording& recording);

}  // namespace pneuservo
