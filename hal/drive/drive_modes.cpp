// The axis as a drive: profile position, homing and cyclic synchronous position, and what is shown of the axis.
#include <algorithm>
#include <cmath>

#include "drive/drive_node.hpp"

namespace pneuservo {
namespace {

namespace object = drive_object;

constexpr std::uint32_t window_off = 0xFFFFFFFF;
/// Slower than this share of the limit no move goes (as for every commander): it would not end.
constexpr double slowest_share = 1e-3;

}  // namespace

void DriveNode::change_mode() {
  const auto wanted = static_cast<std::int8_t>(number(object::mode));
  if (wanted == static_cast<std::int8_t>(mode())) return;
  if (accept_drive_object(node_.dictionary(), object::mode, 0, number(object::mode)) != SdoAbort::none) return;
  set(object::mode_display, number(object::mode));
  forget_motion();
}

/// Set points that are not obeyed yet, and what a mode has pending.
void DriveNode::forget_motion() {
  next_.reset();
  newest_m_.reset();
  under_way_ = acknowledged_ = is_halted_ = is_cut_ = homing_failed_ = false;
  target_writes_ = node_.dictionary().find(object::target_position, 0)->writes;
}

void DriveNode::act_in_mode() {
  if (mode() == DriveMode::profile_position) act_in_profile();
  if (mode() == DriveMode::homing) act_in_homing();
  if (mode() == DriveMode::cyclic_position) act_in_cyclic();
}

void DriveNode::act_in_profile() {
  halt_or_resume();
  if ((rising_ & control_new_set_point) != 0) take_set_point();
  if (under_way_ && !is_halted_ && rests()) under_way_ = false;
  if (!under_way_ && !is_halted_ && next_) {
    start_set_point(*next_);
    next_.reset();
  }
  if ((controlword_ & control_new_set_point) == 0 && !next_) acknowledged_ = false;
}

void DriveNode::halt_or_resume() {
  if ((rising_ & control_halt) != 0 && !is_halted_) {
    is_halted_ = true;
    ask({CommandKind::hold});
  }
  if ((falling_ & control_halt) == 0 || !is_halted_) return;
  is_halted_ = false;
  if (next_ && next_->is_immediate) under_way_ = false;
  else if (under_way_) ask({CommandKind::resume});
}

// One set point under way and one that waits, as the profile has it; a third is not acknowledged.
void DriveNode::take_set_point() {
  SetPoint set_point;
  set_point.is_relative = (controlword_ & control_relative) != 0;
  set_point.is_immediate = (controlword_ & control_change_immediately) != 0;
  const std::uint32_t place = number(object::target_position);
  set_point.position_m = set_point.is_relative ? from_drive_units(static_cast<std::int32_t>(place)) : to_axis_m(place);
  const double speed_mps = from_drive_units(number(object::profile_speed));
  set_point.is_cut = speed_mps > most_mps_ + 0.5 / drive_units_per_m;
  set_point.speed_mps = std::clamp(speed_mps, slowest_share * most_mps_, most_mps_);
  if (is_halted_ || (under_way_ && !set_point.is_immediate)) {
    if (next_ && !set_point.is_immediate) return;
    next_ = set_point;
  } else {
    next_.reset();
    start_set_point(set_point);
  }
  acknowledged_ = true;
}

// CiA 402 holds targets to the software limits and says so.
void DriveNode::start_set_point(const SetPoint& set_point) {
  const double wanted_m = set_point.position_m + (set_point.is_relative ? target_m_ : 0.0);
  target_m_ = std::clamp(wanted_m, lowest_m_, highest_m_);
  is_cut_ = set_point.is_cut || target_m_ != wanted_m;
  under_way_ = true;
  ask({.kind = CommandKind::move_to, .target = target_m_, .rate = set_point.speed_mps});
}

// The encoder or its calibration knows the place: nothing has to be looked for. The zero of the bus can be set where
// the axis stands.
void DriveNode::act_in_homing() {
  halt_or_resume();
  if ((rising_ & control_new_set_point) == 0) return;
  homing_failed_ = !rests();
  if (homing_failed_ || static_cast<std::int8_t>(number(object::homing_method)) == 0) return;
  shift_ = std::int64_t{to_drive_units(status_.set_point)} - static_cast<std::int32_t>(number(object::home_offset));
  set(object::position_limit, of_axis(lowest_m_), 1);
  set(object::position_limit, of_axis(highest_m_), 2);
}

void DriveNode::act_in_cyclic() {
  const DictionaryEntry& target = *node_.dictionary().find(object::target_position, 0);
  if (target.writes != target_writes_) {
    target_writes_ = target.writes;
    const double wanted_m = to_axis_m(target.value);
    newest_m_ = std::clamp(wanted_m, lowest_m_, highest_m_);
    is_cut_ = *newest_m_ != wanted_m;
  }
  if (!newest_m_ || followed_.size() >= most_followed) return;
  AxisCommand follow{.kind = CommandKind::follow, .target = *newest_m_};
  const auto exponent = static_cast<std::int8_t>(number(object::interpolation, 2));
  follow.interval_s = number(object::interpolation, 1) * std::pow(10.0, exponent);
  target_m_ = *newest_m_;
  newest_m_.reset();
  ask(follow);
}

void DriveNode::judge_windows() {
  const double x_m = status_.measured[Signal::x];
  const auto held = [&](std::optional<double>& since_s, bool holds, std::uint16_t for_ms) {
    if (!holds) since_s.reset();
    else if (!since_s) since_s = status_.t_s;
    return since_s && status_.t_s - *since_s >= 1e-3 * number(for_ms);
  };
  const std::uint32_t following = number(object::following_window), position = number(object::position_window);
  const bool is_on = state_ == DriveState::operation_enabled;
  const bool behind =
      is_on && following != window_off && std::fabs(status_.set_point - x_m) > from_drive_units(following);
  is_behind_ = held(behind_since_s_, behind, object::following_time);
  const bool at_target = knows() && std::fabs(status_.target - target_m_) <= 0.5 / drive_units_per_m;
  const bool near = is_on && at_target &&
                    (position == window_off ? rests() : std::fabs(target_m_ - x_m) <= from_drive_units(position));
  is_reached_ = held(near_since_s_, near, object::position_time);
}

std::uint16_t DriveNode::bits_of_mode() const {
  if (state_ != DriveState::operation_enabled) return 0;
  std::uint16_t bits = is_cut_ || status_.is_late ? status_internal_limit : std::uint16_t{0};
  const auto add = [&](bool holds, std::uint16_t bit) { bits |= holds ? bit : std::uint16_t{0}; };
  switch (mode()) {
    case DriveMode::profile_position:
      add(is_halted_ ? rests() : is_reached_ && !next_, status_target_reached);
      add(acknowledged_, status_of_mode);
      add(is_behind_, status_error_of_mode);
      break;
    case DriveMode::homing:
      add(rests(), status_target_reached);
      add(!homing_failed_, status_of_mode);
      add(homing_failed_, status_error_of_mode);
      break;
    case DriveMode::cyclic_position:
      add(!leaving_to_, status_of_mode);
      add(is_behind_, status_error_of_mode);
      break;
    case DriveMode::none: break;
  }
  return bits;
}

std::uint16_t DriveNode::statusword() const {
  std::uint16_t word = status_bits(state_) | status_remote;
  if (status_.tick >= 0 && status_.faults == 0) word |= status_voltage_enabled;
  if (state_ == DriveState::operation_enabled && !status_.proven) word |= status_warning;
  return word | bits_of_mode();
}

void DriveNode::show_values() {
  set(object::statusword, statusword());
  set(object::faults, static_cast<std::int64_t>(status_.faults & 0xFFFFFFFF), 1);
  set(object::faults, static_cast<std::int64_t>(status_.faults >> 32), 2);
  set(object::stream_delay, std::llround(1e6 * status_.stream_delay_s));
  const double x_m = status_.measured[Signal::x];
  if (std::isfinite(x_m)) set(object::position_actual, of_axis(x_m));
  if (std::isfinite(status_.v_mps)) set(object::speed_actual, to_drive_units(status_.v_mps));
  // An axis that nobody commands is where it shall be.
  const bool is_commanded = status_.state == SupervisorState::active && std::isfinite(status_.set_point);
  const double demand_m = is_commanded ? status_.set_point : x_m;
  if (std::isfinite(demand_m)) set(object::position_demand, of_axis(demand_m));
  set(object::speed_demand, is_commanded ? to_drive_units(status_.set_point_rate) : 0);
  if (std::isfinite(x_m)) set(object::following_error, to_drive_units(demand_m - x_m));
}

}  // namespace pneuservo
