// Where a running loop takes commands, obeys them and says how it is; without a link it does nothing.
#pragma once
#include <cstdint>

#include <pneuservo/loop/axis_command.hpp>
#include <pneuservo/loop/commanded_motion.hpp>
#include <pneuservo/loop/supervisor.hpp>

namespace pneuservo {

/// One command a tick, before anything is judged; a motion waits for its place in the pass. All of it but configure is
/// HOT.
class CommandDesk {
 public:
  /// Inputs that are not ready for so long after `enable` take it back.
  static constexpr double enabled_within_s = 2.0;

  void configure(const LiveLimits& limits, double period_s, double lead_s, double wait_s = 0.0) {
    motion_.configure(limits, period_s, lead_s, wait_s);
    period_s_ = period_s;
  }
  /// Whoever commands; null: nobody, the loop runs its reference. Before the first pass.
  void set_link(CommandLink* link) noexcept { link_ = link; }
  bool is_open() const noexcept { return link_ != nullptr; }
  /// Nothing moves before.
  bool enabled() const noexcept { return link_ == nullptr || enabled_; }

  /// At the begin of a tick. `rearm`: the loop's way back from a stop or fault.
  template <class Rearm> void take_command(std::int64_t tick, Supervisor& supervisor, Rearm&& rearm) noexcept {
    obeyed_ = CommandKind::none;
    const double waited_s = static_cast<double>(tick - enabled_tick_) * period_s_;
    if (supervisor.faults() != 0 || (!supervisor.is_active() && waited_s > enabled_within_s)) enabled_ = false;
    if (!waits_ && !link_->commands.pop(command_)) return;
    waits_ = is_motion(command_.kind) && supervisor.is_active();
    if (waits_) return;
    if (is_motion(command_.kind))
      return answer(supervisor.faults() != 0 ? CommandResult::in_fault : CommandResult::not_enabled, tick);
    answer(obey_state(command_.kind, tick, supervisor, rearm), tick);
  }
  /// The motion that waits, in its place of the pass of an active loop, between pass() and advance() of motion().
  void obey_motion(std::int64_t tick) noexcept {
    CommandResult result = CommandResult::taken;
    if (!waits_ || !motion_.obey(command_, tick, result)) return;
    waits_ = false;
    answer(result, tick);
  }
  /// Begins at rest, plans, obeys: the set point of a tick then stands in motion().
  void move(std::int64_t tick, bool begins, double from, bool proven) noexcept {
    if (begins) motion_.start(tick, from);
    motion_.pass(tick, proven);
    obey_motion(tick);
    motion_.advance(tick);
  }
  /// `status`: what the loop alone knows of itself.
  void tell(std::int64_t tick, const Supervisor& supervisor, AxisStatus status) noexcept {
    status.tick = tick;
    status.state = supervisor.state();
    status.enabled = enabled_;
    status.faults = supervisor.faults();
    status.first_faults = supervisor.first_faults();
    status.target = motion_.target_m();
    status.end_tick = motion_.end_tick();
    status.is_late = status.is_late || motion_.is_late();
    status.stream_delay_s = motion_.stream().delay_s();
    status.u_V = supervisor.command_V()[0];
    link_->status.post(status);
  }

  /// What was obeyed in this tick, and with which numbers.
  CommandKind obeyed() const noexcept { return obeyed_; }
  const AxisCommand& command() const noexcept { return command_; }
  const CommandedMotion& motion() const noexcept { return motion_; }

 private:
  template <class Rearm>
  CommandResult obey_state(CommandKind kind, std::int64_t tick, Supervisor& supervisor, Rearm& rearm) noexcept {
    const bool in_fault = supervisor.faults() != 0;
    switch (kind) {
      case CommandKind::enable:
        if (in_fault) return CommandResult::in_fault;
        if (enabled_) return CommandResult::is_enabled;
        enabled_ = true;
        enabled_tick_ = tick;
        if (supervisor.state() == SupervisorState::safe_stop) rearm();
        break;
      case CommandKind::disable:
        enabled_ = false;
        supervisor.stop();
        break;
      case CommandKind::reset:
        if (!in_fault) return CommandResult::no_fault;
        enabled_ = false;
        rearm();
        break;
      default: break;
    }
    return CommandResult::taken;
  }
  void answer(CommandResult result, std::int64_t tick) noexcept {
    link_->answers.push({command_.number, result, tick, motion_.target_m(), motion_.end_tick()});
    if (result == CommandResult::taken) obeyed_ = command_.kind;
  }

  CommandLink* link_ = nullptr;
  CommandedMotion motion_;
  AxisCommand command_;  // taken, and where waits_ not obeyed yet
  CommandKind obeyed_ = CommandKind::none;
  bool enabled_ = false, waits_ = false;
  std::int64_t enabled_tick_ = 0;
  double period_s_ = 0.0;
};

}  // namespace pneuservo
