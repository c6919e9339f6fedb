// Doubt before a search: the order in which channels are judged.
#include "diagnosis/doubts/recording_doubts.hpp"

#include "diagnosis/doubts/channel_doubts.hpp"
#include "diagnosis/doubts/range_doubts.hpp"
#include "diagnosis/doubts/unit_doubts.hpp"
#include "diagnosis/doubts/wiring_doubts.hpp"
#include "diagnosis/recordings/stretches.hpp"

namespace pneuservo {

void doubt_recordings(Rig& rig, std::vector<Recording>& recordings, std::vector<std::string>& notes) {
  if (!rig.has_controller()) return;
  refuse_intervals(rig, recordings);
  for (Recording& recording : recordings) {
    leave_out_absent_sensors(rig, recording, notes);
    unwrap_position(rig, recording, notes);
    doubt_position_unit(rig, recording, notes);
    doubt_units(rig, recording, notes);
    refuse_repeated_channels(rig, recording);
    take_resolution(rig, recording, notes);
    take_out_impossible_samples(rig, recording, notes);
    refuse_standstill(rig, recording);
    doubt_wiring(rig, recording, notes);
    doubt_sampling(rig, recording, notes);
  }
}

}  // namespace pneuservo
