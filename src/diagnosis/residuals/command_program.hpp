// Commands of an on/off valve along a recording: of its column u_V, or of the config's program.
#pragma once
#include <cstddef>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// Each command holds from its time on; the first one also before its time.
struct CommandProgram {
  std::vector<double> times_s;
  std::vector<double> commands;
  double at(double time_s) const;
  /// The time at which the command changes next, or `most_s` where that is earlier.
  double next_change_s(double time_s, double most_s) const;
};

/// The changes of u_V, the first value from the first row on or from 0, whichever is earlier (a recording may be cut
/// out of what was logged from an event at t = 0 on); without u_V the config's program from the first row on.
CommandProgram command_program(const Rig& rig, const Recording& recording);

/// As the valve carries it out: every command from the number `first` on `delay_s` late, those below 0 another
/// `drop_out_s`.
CommandProgram carried_out(CommandProgram program, std::size_t first, double delay_s, double drop_out_s = 0.0);

}  // namespace pneuservo
