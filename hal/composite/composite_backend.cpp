// Backend `configured`.
#include "composite/composite_backend.hpp"

#include <algorithm>

#include "can/can_backend.hpp"
#include "comedi/comedi_backend.hpp"
#include "config/input_error.hpp"
#include "gpio/gpio_backend.hpp"
#include "guard/guard_link.hpp"
#include "iio/iio_backend.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {

CompositeBackend::CompositeBackend(const Rig& rig) {
  for (const Signal signal : channel_signals)
    if (const auto zero = rig.zeros.find(std::string(info(signal).name)); zero != rig.zeros.end())
      zeros_[signal] = zero->second;
  if (!rig.hal)
    throw InputError(rig.name + ": hal: found nothing, expected the section with the rig's devices (docs/can.md); "
                                "'--hal sim' runs on the simulated plant");
  const HalChannels& c = rig.hal->channels;
  Gives simulated{}, on_can{}, on_board{}, on_iio{};
  c.for_each_input([&](Signal signal, const auto& channel) {
    simulated[signal] = channel.simulated;
    on_can[signal] = channel.can.has_value();
    on_board[signal] = channel.is_on_board();
    on_iio[signal] = channel.iio.has_value();
    origins_.channels[signal] = channel.is_absent() ? Origin::absent
                                : channel.simulated ? Origin::simulated
                                                    : Origin::real;
  });
  bool commands_sim = false, commands_can = false, commands_board = false, commands_iio = false, is_real = false;
  c.for_each_command([&](std::string_view, std::size_t, const auto& valve) {
    commands_sim = commands_sim || valve.simulated;
    commands_can = commands_can || valve.can;
    commands_board = commands_board || valve.is_on_board();
    commands_iio = commands_iio || valve.iio;
    is_real = is_real || valve.is_real();
  });
  origins_.command = is_real ? Origin::real : Origin::simulated;
  const auto any = [](const Gives& gives) { return std::ranges::find(gives.all, true) != gives.all.end(); };
  if (commands_sim || any(simulated)) sources_.push_back({std::make_unique<SimBackend>(rig), simulated});
  if (commands_board || any(on_board)) sources_.push_back({std::make_unique<ComediBackend>(rig), on_board});
  if (commands_iio || any(on_iio)) sources_.push_back({std::make_unique<IioBackend>(rig), on_iio});
  if (commands_can || any(on_can)) sources_.push_back({std::make_unique<CanBackend>(rig), on_can});
  // Last: the newest state of the lines in a tick, and enabled after the command is out.
  if (rig.hal->gpio) sources_.push_back({std::make_unique<GpioBackend>(rig), {}});
  // Its sign of life says that all outputs were written.
  if (rig.hal->guard) sources_.push_back({std::make_unique<GuardLink>(rig), {}});
}

Origins CompositeBackend::origins() const {
  Origins all = origins_;
  for (const Source& source : sources_) {
    const auto lines = source.backend->origins().lines;
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (lines[i] != Origin::absent) all.lines[i] = lines[i];
  }
  return all;
}

SafeOutput CompositeBackend::safe_output() const {
  SafeOutput all{.is_simulated = origins_.command == Origin::simulated, .is_read_back = true};
  // Of all that have outputs the last one counts, and one that has not done it yet.
  const auto later = [&](std::int64_t& whole, std::int64_t part) {
    whole = !all.has_outputs ? part : whole < 0 || part < 0 ? -1 : std::max(whole, part);
  };
  for (const Source& source : sources_) {
    const SafeOutput part = source.backend->safe_output();
    if (!part.has_outputs || (part.is_simulated && !all.is_simulated)) continue;
    later(all.sent_tick, part.sent_tick);
    later(all.confirmed_tick, part.confirmed_tick);
    all.stop_tick = std::max(all.stop_tick, part.stop_tick);
    later(all.substitute_tick, part.substitute_tick);
    all.is_read_back = all.is_read_back && part.is_read_back;
    all.has_outputs = true;
  }
  return all;
}

void CompositeBackend::configure() {
  // Guard and lines first: without them no device is touched.
  for (auto source = sources_.rbegin(); source != sources_.rend(); ++source) source->backend->configure();
}

void CompositeBackend::activate() {
  for (Source& source : sources_) source.backend->activate();
}

bool CompositeBackend::is_paced() const noexcept {
  return std::ranges::any_of(sources_, [](const Source& source) { return source.backend->is_paced(); });
}

Pace CompositeBackend::await_sample() noexcept {
  for (Source& source : sources_)
    if (source.backend->is_paced()) return source.backend->await_sample();
  return {};
}

bool CompositeBackend::read(std::int64_t tick, Measurement& measurement) noexcept {
  for (Source& source : sources_) {
    Measurement part;
    if (!source.backend->read(tick, part)) return false;
    for (const Signal signal : channel_signals)
      if (source.gives[signal])
        measurement.channel[signal] = part.channel[signal], measurement.channel[signal].value += zeros_[signal];
    measurement.device_faults |= part.device_faults;
    const auto lines = lines_of(measurement.digital), own = lines_of(part.digital);
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (own[i]->state != LineState::absent) *lines[i] = *own[i];
  }
  return true;
}

bool CompositeBackend::write(std::int64_t tick, const Command& command) noexcept {
  bool all = true;
  for (Source& source : sources_) all = source.backend->write(tick, command) && all;
  return all;
}

void CompositeBackend::deactivate() noexcept {
  for (Source& source : sources_) source.backend->deactivate();
}

bool CompositeBackend::emergency_write() noexcept {
  bool all = true;
  for (Source& source : sources_) all = source.backend->emergency_write() && all;
  return all;
}

std::vector<std::string> CompositeBackend::notes() const {
  std::vector<std::string> all;
  for (const Source& source : sources_)
    for (std::string& line : source.backend->notes()) all.push_back(std::move(line));
  return all;
}

}  // namespace pneuservo
