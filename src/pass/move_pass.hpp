// Command passes of moves that come at run time (docs/physics/command_pass.md).
#pragma once
#include <string>

#include <pneuservo/control/live_planner.hpp>
#include <pneuservo/control/pd_force.hpp>
#include <pneuservo/loop/move_passes.hpp>
#include <pneuservo/rig/rig.hpp>

#include "pass/command_pass.hpp"

namespace pneuservo {

/// Makes them for one rig with a reference of kind `live`. Cold; of one thread.
class MovePassMaker {
 public:
  explicit MovePassMaker(const Rig& rig);
  /// Learns along the move, from rest at the pressure that the request states. Without a pass `out` has no ticks, and
  /// why is returned, in a sentence without its full stop; empty where `goes_on` ended the work.
  std::string make(const MovePassRequest& request, MovePass& out, const GoesOn& goes_on);
  /// Of a move that began before its pass was there.
  static std::string late_words(const PlannedMove& move);

 private:
  std::shared_ptr<const LivePlanner> planned(const PlannedMove& move) const;

  Rig rig_;
  LivePlanner planner_;
  PdForce law_;
};

}  // namespace pneuservo
