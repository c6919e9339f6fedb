// A supposed rig as it was while each recording was made: owners change their machines between recordings.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "config/rig_parameters.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// One number that the owner changed for a recording. Whatever it truly was before, it is `factor` times that and
/// `added` more: a gauge that reads 2 % low does so at every pressure, and a load comes on top of what was there.
struct MachineChange {
  ParameterHandle number;
  double factor = 1;
  double added = 0;             ///< [unit of the path], where the config has 0
  double lower = 0, upper = 0;  ///< of the path's field
};
using MachineChanges = std::vector<MachineChange>;

/// What the owner changed of his rig for this recording (Recording::changed). Throws InputError for a path that the rig
/// does not have or that is none of its physics, and for a value out of its range.
MachineChanges machine_changes(const Rig& owner, const Recording& recording);

/// The rig, the owner's or a supposed one, with these changes made; within each number's range.
Rig changed_rig(Rig rig, const MachineChanges& changes);

/// A hypothesis' rig at each recording; no copy where nothing was changed.
class RecordedRigs {
 public:
  /// Keeps a reference to the rig. Parts: CylinderRecording and whatever else has `changes`.
  template <class Parts> RecordedRigs(const Rig& rig, const Parts& parts) : rig_(&rig) {
    for (const auto& part : parts)
      changed_.push_back(part.changes.empty() ? std::nullopt : std::optional<Rig>(changed_rig(rig, part.changes)));
  }
  /// The rig of this recording alone, to be changed further.
  Rig& own(std::size_t recording) {
    if (!changed_[recording]) changed_[recording] = *rig_;
    return *changed_[recording];
  }
  const Rig& operator[](std::size_t recording) const { return changed_[recording] ? *changed_[recording] : *rig_; }

 private:
  const Rig* rig_;
  std::vector<std::optional<Rig>> changed_;
};

}  // namespace pneuservo
