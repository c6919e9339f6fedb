// The axis as a drive on a CAN bus (CiA 402): a CANopen node that makes commands of the axis out of controlword, modes
// and set points, and statusword and actual values out of its status. Time is given to it, so that tests need no clock.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include <pneuservo/loop/axis_command.hpp>
#include <pneuservo/rig/rig.hpp>

#include "can/canopen_node.hpp"
#include "drive/drive_objects.hpp"
#include "drive/drive_state.hpp"

namespace pneuservo {

/// Commands, answers and status pass as they do for any other commander of the axis: it asks, and believes the status.
class DriveNode {
 public:
  /// The rig must have serve.drive and a reference of kind live.
  explicit DriveNode(const Rig& rig);

  void power_on(std::int64_t now_ns, std::vector<CanFrame>& out);
  /// Any frame of the bus, SYNC too.
  void on_frame(const CanFrame& frame, std::int64_t now_ns, std::vector<CanFrame>& out);
  /// The bus itself comes or goes.
  void on_link(bool is_up, std::vector<CanFrame>& out);
  void on_time(std::int64_t now_ns, std::vector<CanFrame>& out);
  std::int64_t next_due_ns() const noexcept { return node_.next_due_ns(); }
  /// What came of a command, and how the axis is.
  void on_answer(const AxisAnswer& answer, std::vector<CanFrame>& out);
  void on_status(const AxisStatus& status, std::vector<CanFrame>& out);

  /// What the drive has to say to the axis since the last call, in this order.
  std::vector<CommanderWord> take_words();

  DriveState state() const noexcept { return state_; }
  const CanopenNode& node() const noexcept { return node_; }
  CanopenNode& node() noexcept { return node_; }

 private:
  using Frames = std::vector<CanFrame>;
  struct SetPoint {
    double position_m = 0.0, speed_mps = 0.0;
    bool is_relative = false, is_immediate = false, is_cut = false;
  };
  /// More set points of a stream than that without an answer: the newest waits, older ones go.
  static constexpr std::size_t most_followed = 4;

  // The state machine.
  void act(Frames& out);
  void obey_controlword();
  void change_state(DriveState to);
  void follow_axis();
  void enter_operation();
  void leave(DriveState to, bool at_rest);
  void begin_quick_stop();
  void disable_axis();
  void judge_faults(Frames& out);
  void reset_fault(Frames& out);
  void report_error(std::uint16_t code, Frames& out);
  void check_master(NmtState before, Frames& out);
  void lose_master(Frames& out);
  bool hears_master(const CanFrame& frame) const;
  void ask(AxisCommand command);
  void say(CommanderWord::Kind kind) { words_.push_back({kind, {}}); }

  // The modes: drive_modes.cpp.
  void change_mode();
  void forget_motion();
  void act_in_mode();
  void act_in_profile();
  void act_in_homing();
  void act_in_cyclic();
  void halt_or_resume();
  void take_set_point();
  void start_set_point(const SetPoint& set_point);
  void judge_windows();
  void show_values();
  std::uint16_t statusword() const;
  std::uint16_t bits_of_mode() const;

  /// Enabled, or on its way there.
  bool is_busy() const noexcept {
    return enabling_ || state_ == DriveState::operation_enabled || state_ == DriveState::quick_stop_active;
  }
  /// The status has seen all that was asked for.
  bool knows() const noexcept { return waiting_ == 0 && status_.tick >= sure_tick_; }
  bool rests() const noexcept { return knows() && status_.tick >= status_.end_tick; }
  std::uint32_t number(std::uint16_t index, std::uint8_t sub = 0) const {
    return node_.dictionary().number(index, sub);
  }
  std::int16_t option(std::uint16_t index) const { return static_cast<std::int16_t>(number(index)); }
  void set(std::uint16_t index, std::int64_t value, std::uint8_t sub = 0) {
    node_.dictionary().set_number(index, sub, static_cast<std::uint32_t>(value));
  }
  DriveMode mode() const {
    return static_cast<DriveMode>(static_cast<std::int8_t>(number(drive_object::mode_display)));
  }
  /// Place on the bus = place of the axis - shift.
  double to_axis_m(std::uint32_t object) const { return from_drive_units(static_cast<std::int32_t>(object) + shift_); }
  std::int64_t of_axis(double position_m) const { return std::int64_t{to_drive_units(position_m)} - shift_; }

  CanopenNode node_;
  double lowest_m_, highest_m_, most_mps_;
  std::int64_t silent_ns_, heard_ns_ = 0, now_ns_ = 0;
  bool is_substituted_ = false, is_up_ = true;
  std::vector<CommanderWord> words_;

  DriveState state_ = DriveState::not_ready_to_switch_on;
  std::optional<DriveState> leaving_to_;  // once the axis rests
  std::uint16_t controlword_ = 0, rising_ = 0, falling_ = 0;  // as obeyed last, and what it changed
  bool may_enable_ = false;  // the edge to enable_operation waits for its state
  bool enabling_ = false, reset_asked_ = false, is_own_fault_ = false;
  std::uint64_t numbers_ = 0;
  int waiting_ = 0;  // for answers, but those of a stream
  std::int64_t sure_tick_ = -1;  // in which the last answered command was obeyed
  std::vector<std::uint64_t> followed_;  // set points of a stream without an answer
  AxisStatus status_;

  std::optional<SetPoint> next_;
  bool under_way_ = false, acknowledged_ = false, is_halted_ = false, is_cut_ = false;
  double target_m_ = 0.0;
  std::uint32_t target_writes_ = 0;
  std::optional<double> newest_m_;  // set point of a stream that was not asked for yet
  std::int64_t shift_ = 0;
  bool homing_failed_ = false;
  std::optional<double> behind_since_s_, near_since_s_;  // on the clock of the axis
  bool is_behind_ = false, is_reached_ = false;
};

}  // namespace pneuservo
