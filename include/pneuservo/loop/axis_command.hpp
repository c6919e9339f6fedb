// What an axis can be told while it runs, what it answers, and what it says of itself. Targets and rates are in the SI
// units of what is commanded: m and m/s of an axis, Pa and Pa/s of a pressure rig.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <pneuservo/core/signal.hpp>
#include <pneuservo/loop/mailbox.hpp>
#include <pneuservo/loop/supervisor_state.hpp>

namespace pneuservo {

/// The values stand in recordings (column `command_kind`) and stay what they are.
enum class CommandKind : std::uint32_t {
  none,
  enable,   ///< the edge without which nothing moves
  disable,  ///< safe output
  reset,    ///< acknowledges a fault; the axis is not enabled after it
  move_to,
  move_by,
  jog,      ///< at a speed towards the end of the range
  stop,     ///< to rest as fast as the limits allow
  hold,     ///< the same, but the target is kept for `resume`
  resume,
  mark,     ///< nothing but a mark in the recording
  follow,   ///< the next set point of a stream
};
inline constexpr std::array<std::string_view, 12> command_kind_names{
    "none", "enable", "disable", "reset", "move_to", "move_by", "jog", "stop", "hold", "resume", "mark", "follow"};

/// Whether it asks for a motion.
constexpr bool is_motion(CommandKind kind) noexcept {
  return (kind >= CommandKind::move_to && kind <= CommandKind::resume) || kind == CommandKind::follow;
}

struct AxisCommand {
  CommandKind kind = CommandKind::none;
  double target = 0.0;  ///< of move_to and follow; way of move_by
  double rate = 0.0;    ///< of moves and, with its sign, of jog
  std::uint64_t number = 0; ///< comes back with the answer
  double interval_s = 0.0;  ///< of follow: until the next set point comes
};

/// How a command ended. Each has one sentence.
enum class CommandResult : std::uint8_t {
  taken,
  not_enabled,
  in_fault,
  no_fault,
  is_enabled,
  outside,
  nothing_held,
  other_commander,
  too_many,
};
inline constexpr std::array<std::string_view, 9> command_result_texts{
    "taken",
    "not enabled: nothing moves before the command enable",
    "a fault is latched: mend its cause, then the commands reset and enable",
    "no fault is latched: there is nothing to reset",
    "it is enabled already",
    "the target is outside of the range that the reference states",
    "no move was held: there is nothing to resume",
    "there is another commander: it has to release or end first",
    "too many commands are without an answer: wait for answers",
};
constexpr std::string_view text_of(CommandResult result) noexcept {
  return command_result_texts[static_cast<std::size_t>(result)];
}

struct AxisAnswer {
  std::uint64_t number = 0;
  CommandResult result = CommandResult::taken;
  std::int64_t tick = 0;       ///< in which it was obeyed or refused
  double target = 0.0;         ///< of the plan then
  std::int64_t end_tick = 0;   ///< from which on the set point rests
};

/// What a commander in this program says to whoever arbitrates: a command, that it gives the axis back, or that
/// whoever stood behind it is gone.
struct CommanderWord {
  enum class Kind : std::uint8_t { command, release, lost } kind = Kind::command;
  AxisCommand command;
};

/// After each tick.
struct AxisStatus {
  std::int64_t tick = -1;
  double t_s = 0.0;
  SupervisorState state = SupervisorState::unconfigured;
  bool enabled = false;  ///< told to be; `state` says what it is
  bool proven = false;   ///< the start is: until then moves are slow
  bool follows_pass = false;  ///< that of the last move, its rest included
  std::uint64_t faults = 0, first_faults = 0;
  PerSignal<double> measured;  ///< behind the known gain and offset of the sensors; NaN: no valid sample
  double v_mps = 0.0;  ///< as the law sees it; of an axis
  double p_Pa = 0.0;   ///< as the law sees it; of a pressure rig
  double set_point = 0.0, set_point_rate = 0.0, target = 0.0;
  std::int64_t end_tick = 0;
  bool is_late = false;  ///< the set points of a stream are faster than the limits, or the valve feeds no more
  double stream_delay_s = 0.0;  ///< from a set point of a stream to the axis' own
  double u_V = 0.0;
};

/// Between the running loop and the one thread that speaks for it; no side ever waits.
struct CommandLink {
  /// More than a thread that looks every few milliseconds leaves lying.
  static constexpr std::size_t most_waiting = 64;
  WaitFreeQueue<AxisCommand, most_waiting> commands;
  /// A command is answered once, so that answers fit where never more than most_waiting commands are unanswered.
  WaitFreeQueue<AxisAnswer, most_waiting> answers;
  Mailbox<AxisStatus> status;
};

}  // namespace pneuservo
