// The axis as a drive: the state machine of CiA 402, and what passes between bus and axis.
#include "drive/drive_node.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pneuservo {
namespace {

namespace object = drive_object;

constexpr std::uint16_t error_heartbeat = 0x8130, error_other_commander = 0xFF01;
constexpr std::uint8_t register_generic = 0x01, register_manufacturer = 0x80;
/// What is sent at once where it changes and its PDO is event-driven.
constexpr std::array<std::uint16_t, 3> events{object::statusword, object::mode_display, object::error_code};

}  // namespace

DriveNode::DriveNode(const Rig& rig)
    : node_({static_cast<std::uint8_t>(rig.serve->drive->node_id), drive_device_type, rig.name}),
      lowest_m_(rig.reference.lowest_m), highest_m_(rig.reference.highest_m), most_mps_(rig.reference.speed_mps),
      silent_ns_(std::llround(rig.serve->commander_silent_s * 1e9)) {
  add_drive_objects(rig, node_);
  node_.accept_application = [this](std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
    return accept_drive_object(node_.dictionary(), index, sub, value);
  };
}

void DriveNode::power_on(std::int64_t now_ns, Frames& out) {
  now_ns_ = heard_ns_ = now_ns;
  node_.power_on(now_ns, out);
}

void DriveNode::on_frame(const CanFrame& frame, std::int64_t now_ns, Frames& out) {
  now_ns_ = now_ns;
  if (hears_master(frame)) heard_ns_ = now_ns;
  const NmtState before = node_.state();
  if (is_sync(frame)) {
    node_.act_on_sync();
    act(out);
    node_.answer_sync(out);
    return;
  }
  node_.on_frame(frame, now_ns, out);
  check_master(before, out);
  act(out);
}

void DriveNode::on_link(bool is_up, Frames& out) {
  if (is_up_ && !is_up) lose_master(out);
  is_up_ = is_up;
}

void DriveNode::on_time(std::int64_t now_ns, Frames& out) {
  now_ns_ = now_ns;
  const NmtState before = node_.state();
  node_.on_time(now_ns, out);
  check_master(before, out);
}

bool DriveNode::hears_master(const CanFrame& frame) const {
  if (frame.id == cob_nmt || is_sync(frame) || frame.id == cob_sdo_request + node_.node()) return true;
  for (std::uint16_t pdo = 0; pdo < 4; ++pdo)
    if (frame.id == number(static_cast<std::uint16_t>(0x1400 + pdo), 1)) return true;
  const auto heartbeat = parse_heartbeat(frame);
  return heartbeat && heartbeat->node == (number(0x1016, 1) >> 16 & 0x7F);
}

/// Its heartbeat is missing, it has stopped or reset the node, or says nothing for too long.
void DriveNode::check_master(NmtState before, Frames& out) {
  const bool left = before == NmtState::operational && node_.state() != NmtState::operational;
  const bool missed = node_.is_substituted() && !std::exchange(is_substituted_, node_.is_substituted());
  is_substituted_ = node_.is_substituted();
  const bool silent = silent_ns_ > 0 && is_busy() && now_ns_ - heard_ns_ > silent_ns_;
  if (silent) heard_ns_ = now_ns_;
  if (left || missed || silent) lose_master(out);
}

void DriveNode::lose_master(Frames& out) {
  if (!is_busy()) return;
  next_.reset();
  newest_m_.reset();
  switch (static_cast<DriveAbort>(option(object::abort_option))) {
    case DriveAbort::as_configured: say(CommanderWord::Kind::lost); break;
    case DriveAbort::nothing: break;
    case DriveAbort::fault:
      disable_axis();
      is_own_fault_ = true;
      change_state(DriveState::fault);
      report_error(error_heartbeat, out);
      break;
    case DriveAbort::disable_voltage: leave(DriveState::switch_on_disabled, false); break;
    case DriveAbort::quick_stop: begin_quick_stop(); break;
  }
}

void DriveNode::on_answer(const AxisAnswer& answer, Frames& out) {
  const bool refused = answer.result != CommandResult::taken && answer.result != CommandResult::is_enabled;
  if (const auto of_stream = std::ranges::find(followed_, answer.number); of_stream != followed_.end()) {
    followed_.erase(of_stream);
  } else {
    waiting_ = std::max(waiting_ - 1, 0);
    if (refused) reset_asked_ = false;
    else sure_tick_ = std::max(sure_tick_, answer.tick);
  }
  if (answer.result == CommandResult::other_commander && enabling_) report_error(error_other_commander, out);
  if (refused) enabling_ = false;
  act(out);
}

void DriveNode::on_status(const AxisStatus& status, Frames& out) {
  status_ = status;
  act(out);
}

std::vector<CommanderWord> DriveNode::take_words() { return std::exchange(words_, {}); }

void DriveNode::ask(AxisCommand command) {
  command.number = ++numbers_;
  words_.push_back({CommanderWord::Kind::command, command});
  if (command.kind == CommandKind::follow) followed_.push_back(command.number);
  else ++waiting_;
}

void DriveNode::act(Frames& out) {
  if (state_ == DriveState::not_ready_to_switch_on && status_.tick >= 0) change_state(DriveState::switch_on_disabled);
  const auto controlword = static_cast<std::uint16_t>(number(object::controlword));
  rising_ = controlword & static_cast<std::uint16_t>(~controlword_);
  falling_ = controlword_ & static_cast<std::uint16_t>(~controlword);
  if (command_of(controlword) != DriveCommand::enable_operation) may_enable_ = false;
  else if (command_of(controlword_) != DriveCommand::enable_operation) may_enable_ = true;
  controlword_ = controlword;
  judge_faults(out);
  reset_fault(out);
  obey_controlword();
  follow_axis();
  change_mode();
  if (state_ == DriveState::operation_enabled && !leaving_to_) act_in_mode();
  judge_windows();
  show_values();
  node_.send_events(events, out);
}

// Faults of the axis have given it the safe output already: the fault's reaction is over when the drive hears of it.
void DriveNode::judge_faults(Frames& out) {
  if (status_.faults == 0 || state_ == DriveState::fault || state_ == DriveState::not_ready_to_switch_on) return;
  if (is_busy()) say(CommanderWord::Kind::release);
  enabling_ = is_own_fault_ = reset_asked_ = false;
  leaving_to_.reset();
  change_state(DriveState::fault);
  report_error(drive_error_code(status_.first_faults), out);
}

void DriveNode::reset_fault(Frames& out) {
  if (state_ != DriveState::fault) return;
  if ((rising_ & control_fault_reset) != 0 && !reset_asked_) {
    reset_asked_ = true;
    if (status_.faults != 0) ask({CommandKind::reset});
  }
  if (!reset_asked_ || !knows()) return;
  if (status_.faults != 0) {  // its cause stands
    reset_asked_ = false;
    return;
  }
  if (!is_own_fault_) say(CommanderWord::Kind::release);
  reset_asked_ = is_own_fault_ = false;
  change_state(DriveState::switch_on_disabled);
  report_error(0, out);
}

void DriveNode::report_error(std::uint16_t code, Frames& out) {
  if (number(object::error_code) == code) return;
  set(object::error_code, code);
  const bool is_own = code >= 0xFF00;
  node_.raise_emergency(code, code == 0 ? 0 : register_generic | (is_own ? register_manufacturer : 0), out);
}

void DriveNode::change_state(DriveState to) {
  if (to != DriveState::operation_enabled) forget_motion();
  state_ = to;
}

void DriveNode::obey_controlword() {
  const DriveCommand command = command_of(controlword_);
  const DriveState to = commanded_state(state_, command);
  if (to == state_) {
    if (state_ == DriveState::operation_enabled) leaving_to_.reset();  // enabled again before it was at rest
    return;
  }
  if (leaving_to_ && *leaving_to_ == to) return;
  if (to == DriveState::operation_enabled) {
    if (state_ == DriveState::quick_stop_active) {
      if (may_enable_ && !leaving_to_) enter_operation();
      return;
    }
    if (state_ == DriveState::ready_to_switch_on) change_state(DriveState::switched_on);
    if (!may_enable_ || enabling_) return;
    may_enable_ = false;
    enabling_ = true;
    return ask({CommandKind::enable});
  }
  if (to == DriveState::quick_stop_active) return begin_quick_stop();
  if (!is_busy()) return change_state(to);
  const bool at_rest = state_ == DriveState::operation_enabled &&
                       ((to == DriveState::switched_on && option(object::disable_option) == 1) ||
                        (to == DriveState::ready_to_switch_on && option(object::shutdown_option) == 1));
  leave(to, at_rest);
}

void DriveNode::leave(DriveState to, bool at_rest) {
  if (at_rest && !rests()) {
    ask({CommandKind::stop});
    leaving_to_ = to;
    return;
  }
  disable_axis();
  change_state(to);
}

void DriveNode::begin_quick_stop() {
  const int how = option(object::quick_stop_option);
  if (how == 0 || enabling_) return leave(DriveState::switch_on_disabled, false);
  ask({CommandKind::stop});
  change_state(DriveState::quick_stop_active);
  leaving_to_.reset();
  if (how < 5) leaving_to_ = DriveState::switch_on_disabled;
}

void DriveNode::disable_axis() {
  ask({CommandKind::disable});
  say(CommanderWord::Kind::release);
  enabling_ = false;
  leaving_to_.reset();
}

void DriveNode::enter_operation() {
  enabling_ = may_enable_ = false;
  leaving_to_.reset();
  change_state(DriveState::operation_enabled);
  forget_motion();
  target_m_ = status_.target;
}

// What was asked of the axis has come, or somebody else has taken it back.
void DriveNode::follow_axis() {
  if (!is_busy() || !knows()) return;
  const bool is_on = status_.enabled && status_.state == SupervisorState::active;
  if (enabling_) {
    if (is_on) enter_operation();
    else if (!status_.enabled) {
      enabling_ = false;
      say(CommanderWord::Kind::release);
    }
    return;
  }
  if (!is_on) {
    say(CommanderWord::Kind::release);
    leaving_to_.reset();
    return change_state(DriveState::switch_on_disabled);
  }
  if (!leaving_to_ || !rests()) return;
  const DriveState to = *leaving_to_;
  disable_axis();
  change_state(to);
}

}  // namespace pneuservo
