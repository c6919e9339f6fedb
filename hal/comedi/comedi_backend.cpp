// Backend `comedi`.
#include "comedi/comedi_backend.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "config/input_error.hpp"

namespace pneuservo {
namespace {

constexpr int most_deviating_ticks = 2;  // as a bad sample is bridged: the third is a fault

}  // namespace

ComediBackend::ComediBackend(const Rig& rig) : rig_(rig) {
  if (!rig.hal || !rig.hal->comedi)
    throw InputError(rig.name + ": hal.comedi: found nothing, expected the board (docs/comedi.md)");
}

void ComediBackend::add_inputs() {
  rig_.hal->channels.for_each_input([&](Signal signal, const auto& parameters) {
    const std::string key(info(signal).name);
    if (const auto& analog = parameters.comedi)
      inputs_.push_back({signal, board_->add_input(key, analog->channel, analog->range, analog->reference),
                         analog->scale, analog->zero, analog->lowest, analog->highest});
    if (const auto& counter = parameters.comedi_counter)
      inputs_.push_back({signal, board_->add_counter(key, counter->subdevice, counter->channel), counter->scale,
                         counter->zero, counter->lowest, counter->highest, true});
  });
}

void ComediBackend::add_outputs() {
  rig_.hal->channels.for_each_command([&](std::string_view name, std::size_t command, const auto& parameters) {
    const std::string key(name);
    const auto& analog = parameters.comedi;
    if (!analog) return;
    Output output{command, board_->add_output(key, analog->channel, analog->range, analog->reference)};
    output.scale = analog->scale;
    output.zero = analog->zero;
    output.lowest = analog->lowest;
    output.highest = analog->highest;
    if (const auto& readback = analog->readback) {
      output.is_read_back = true;
      output.readback =
          board_->add_input(key + ".comedi.readback", readback->channel, readback->range, analog->reference);
      output.tolerance_V = readback->tolerance_V;
    }
    outputs_.push_back(output);
  });
}

void ComediBackend::configure() {
  deactivate();
  inputs_.clear();
  outputs_.clear();
  board_.reset();
  board_ = std::make_unique<ComediBoard>(*rig_.hal->comedi);
  add_inputs();
  add_outputs();
  if (!board_->read())
    throw std::runtime_error(rig_.hal->comedi->device + ": the driver refuses to read all channels at once");
  description_ = board_->description();
  saturated_ = out_of_limits_ = refused_ = 0;
  written_ = output_fails_ = false;
}

void ComediBackend::activate() {
  active_ = true;
  if (!set_outputs(safe_commands()))
    throw std::runtime_error(rig_.hal->comedi->device + ": the driver refuses to set the outputs");
  board_->arm_watchdog();
  ended_ = false;
  const bool all_read_back =
      std::all_of(outputs_.begin(), outputs_.end(), [](const Output& output) { return output.is_read_back; });
  safe_output_ = {.has_outputs = !outputs_.empty(), .is_read_back = all_read_back};
}

double ComediBackend::value_of(Input& input) noexcept {
  if (!input.is_counter) return board_->volts(input.number);
  return static_cast<double>(input.count.advance(board_->counts(input.number), board_->last_count(input.number)));
}

bool ComediBackend::read(std::int64_t tick, Measurement& measurement) noexcept {
  if (!board_) return false;
  const bool sampled = board_->read();
  if (!sampled) ++refused_;
  for (Input& input : inputs_) {
    const double raw = value_of(input);
    const double value = input.zero + input.scale * raw;
    const bool saturated = !input.is_counter && board_->is_saturated(input.number);
    const bool within = value >= input.lowest && value <= input.highest;
    if (sampled && saturated) ++saturated_;
    else if (sampled && !within) ++out_of_limits_;
    measurement.channel[input.signal] = {value, 0.0, sampled && !saturated && within, Origin::real};
  }
  const bool confirmed = sampled && written_ && check_outputs();
  if (output_fails_) measurement.device_faults |= device_output_unconfirmed;
  if (ended_ && confirmed && safe_output_.is_read_back && safe_output_.confirmed_tick < 0)
    safe_output_.confirmed_tick = tick;
  return true;
}

bool ComediBackend::check_outputs() noexcept {
  bool all = true;
  for (Output& output : outputs_) {
    if (!output.is_read_back) continue;
    const double deviation_V = std::fabs(board_->volts(output.readback) - board_->set_volts_of(output.number));
    output.worst_V = std::max(output.worst_V, deviation_V);
    output.deviates = deviation_V > output.tolerance_V ? output.deviates + 1 : 0;
    if (output.deviates > most_deviating_ticks) output_fails_ = true;
    all = all && output.deviates == 0;
  }
  return all;
}

Command ComediBackend::safe_commands() const noexcept {
  const auto volts = safe_commands_V(rig_);
  return {volts[0], volts[1]};
}

bool ComediBackend::set_outputs(const Command& command) noexcept {
  const std::array<double, 2> commands{command.valve_V, command.valve_2_V};
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

bool ComediBackend::write(std::int64_t tick, const Command& command) noexcept {
  if (!board_) return false;
  const bool done = set_outputs(command);
  // Its watchdog is fed with the outputs: after a fault it acts, too.
  if (!command.ended && !board_->feed_watchdog()) return false;
  ended_ = command.ended && done;
  if (ended_ && safe_output_.sent_tick < 0) safe_output_.sent_tick = tick;
  return done;
}

void ComediBackend::deactivate() noexcept {
  if (!board_ || !active_) return;
  active_ = false;
  set_outputs(safe_commands());
  board_->disarm_watchdog();
}

Origins ComediBackend::origins() const {
  Origins all{.command = outputs_.empty() ? Origin::absent : Origin::real};
  for (const Input& input : inputs_) all.channels[input.signal] = Origin::real;
  return all;
}

std::vector<std::string> ComediBackend::notes() const {
  std::vector<std::string> lines;
  for (const std::string& line : description_) lines.push_back("comedi: " + line);
  for (const Output& output : outputs_)
    if (output.is_read_back)
      lines.push_back(
          fmt::format("comedi: output {} was read back within {:.4f} V{}", output.command, output.worst_V,
                      output_fails_ ? ", which is more than its tolerance for three ticks: check its wire" : ""));
  lines.push_back(fmt::format("comedi: {} samples at the converter's end, {} out of limits, {} calls refused",
                              saturated_, out_of_limits_, refused_));
  return lines;
}

}  // namespace pneuservo
