// Scaling, limits, readback and safe output of analog devices.
#include "analog/analog_backend.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuservo {
namespace {

constexpr int most_deviating_ticks = 2;  // as a bad sample is bridged: the third is a fault

}  // namespace

void AnalogBackend::configure() {
  deactivate();
  inputs_.clear();
  outputs_.clear();
  board_.reset();
  board_ = open();
  if (!board_->read()) throw std::runtime_error(device_ + ": the driver refuses to read all channels at once");
  description_ = board_->description();
  saturated_ = out_of_limits_ = refused_ = 0;
  written_ = false;
}

void AnalogBackend::activate() {
  active_ = true;
  if (!set_outputs(safe_commands())) throw std::runtime_error(device_ + ": the driver refuses to set the outputs");
  board_->arm_watchdog();
  ended_ = output_fails_ = false;
  for (Output& output : outputs_) output.deviates = 0;
  const bool all_read_back =
      std::all_of(outputs_.begin(), outputs_.end(), [](const Output& output) { return output.is_read_back; });
  safe_output_ = {.has_outputs = !outputs_.empty(), .is_read_back = all_read_back};
}

double AnalogBackend::value_of(Input& input) noexcept {
  if (!input.is_counter) return board_->volts(input.number);
  return static_cast<double>(input.count.advance(board_->counts(input.number), board_->last_count(input.number)));
}

bool AnalogBackend::read(std::int64_t tick, Measurement& measurement) noexcept {
  if (!board_) return false;
  const bool sampled = board_->read();
  const double age_s = board_->age_s();
  if (!sampled) ++refused_;
  for (Input& input : inputs_) {
    const double raw = value_of(input);
    const double value = input.zero + input.scale * raw;
    const bool saturated = !input.is_counter && board_->is_saturated(input.number);
    const bool within = value >= input.lowest && value <= input.highest;
    if (sampled && saturated) ++saturated_;
    else if (sampled && !within) ++out_of_limits_;
    measurement.channel[input.signal] = {value, age_s, sampled && !saturated && within, Origin::real};
  }
  const bool confirmed = written_ && check_outputs(sampled);
  if (output_fails_) measurement.device_faults |= device_output_unconfirmed;
  if (ended_ && confirmed && safe_output_.is_read_back && safe_output_.confirmed_tick < 0)
    safe_output_.confirmed_tick = tick;
  return true;
}

bool AnalogBackend::check_outputs(bool sampled) noexcept {
  bool all = true;
  for (Output& output : outputs_) {
    if (!output.is_read_back) continue;
    const double deviation_V = std::fabs(board_->volts(output.readback) - board_->set_volts_of(output.number));
    if (sampled) output.worst_V = std::max(output.worst_V, deviation_V);
    output.deviates = !sampled || deviation_V > output.tolerance_V ? output.deviates + 1 : 0;
    if (output.deviates > most_deviating_ticks) output_fails_ = true;
    all = all && output.deviates == 0;
  }
  return all;
}

Command AnalogBackend::safe_commands() const noexcept {
  const auto volts = safe_commands_V(rig_);
  return {volts[0], volts[1]};
}

bool AnalogBackend::set_outputs(const Command& command) noexcept {
  const auto commands = outputs_V(rig_, {command.valve_V, command.valve_2_V});
  for (const Output& output : outputs_) {
    const double wanted = std::isfinite(commands[output.command]) ? commands[output.command] : 0.0;
    const double held = std::clamp(wanted, output.lowest, output.highest);
    board_->set_volts(output.number, (held - output.zero) / output.scale);
  }
  const bool done = board_->write();
  if (!done) ++refused_;
  written_ = done;
  return done;
}

bool AnalogBackend::write(std::int64_t tick, const Command& command) noexcept {
  if (!board_) return false;
  const bool done = set_outputs(command);
  // Its watchdog is fed with the outputs: after a fault it acts, too.
  if (!command.ended && !board_->feed_watchdog()) return false;
  ended_ = command.ended && done;
  if (ended_ && safe_output_.sent_tick < 0) safe_output_.sent_tick = tick;
  return done;
}

void AnalogBackend::deactivate() noexcept {
  if (!board_ || !active_) return;
  active_ = false;
  set_outputs(safe_commands());
  board_->disarm_watchdog();
}

Origins AnalogBackend::origins() const {
  Origins all{.command = outputs_.empty() ? Origin::absent : Origin::real};
  for (const Input& input : inputs_) all.channels[input.signal] = Origin::real;
  return all;
}

std::vector<std::string> AnalogBackend::notes() const {
  std::vector<std::string> lines;
  for (const std::string& line : description_) lines.push_back(name_ + ": " + line);
  for (const Output& output : outputs_)
    if (output.is_read_back)
      lines.push_back(fmt::format(
          "{}: output {} was read back within {:.4f} V{}", name_, output.command, output.worst_V,
          output_fails_ ? ", which is more than its tolerance for three ticks, or it could not be read: check its wire"
                        : ""));
  lines.push_back(fmt::format("{}: {} samples at the converter's end, {} out of limits, {} calls refused", name_,
                              saturated_, out_of_limits_, refused_));
  return lines;
}

}  // namespace pneuservo
