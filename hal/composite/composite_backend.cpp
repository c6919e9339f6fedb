// Backend `configured`.
#include "composite/composite_backend.hpp"

#include <algorithm>

#include "can/can_backend.hpp"
#include "config/input_error.hpp"
#include "rig/can_channels.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {

CompositeBackend::CompositeBackend(const Rig& rig) {
  for (std::size_t i = 0; i < channel_names.size(); ++i)
    if (const auto zero = rig.zeros.find(std::string(channel_names[i])); zero != rig.zeros.end())
      zeros_[i] = zero->second;
  if (!rig.hal)
    throw InputError(rig.name + ": hal: found nothing, expected the section with the rig's devices (docs/can.md); "
                                "'--hal sim' runs on the simulated plant");
  const HalChannels& c = rig.hal->channels;
  const std::array<bool, 6> simulated{c.x.simulated,          c.p1_port.simulated,    c.p2_port.simulated,
                                      c.p1_chamber.simulated, c.p2_chamber.simulated, c.p_supply.simulated};
  std::array<bool, 6> on_can{};
  const auto channels = can_channels(*rig.hal);
  for (const CanChannel& channel : channels)
    if (!channel.is_output) on_can[channel.channel] = true;
  const auto any = [](const std::array<bool, 6>& gives) {
    return std::find(gives.begin(), gives.end(), true) != gives.end();
  };
  if (any(simulated) || c.u.simulated || c.u1.simulated || c.u2.simulated)
    sources_.push_back({std::make_unique<SimBackend>(rig), simulated});
  if (!channels.empty()) sources_.push_back({std::make_unique<CanBackend>(rig), on_can});
  for (std::size_t i = 0; i < origins_.size(); ++i)
    origins_[i] = on_can[i] ? Origin::real : simulated[i] ? Origin::simulated : Origin::absent;
}

void CompositeBackend::configure() {
  for (Source& source : sources_) source.backend->configure();
}

void CompositeBackend::activate() {
  for (Source& source : sources_) source.backend->activate();
}

bool CompositeBackend::read(std::int64_t tick, Measurement& measurement) noexcept {
  const auto to = channels_of(measurement);
  for (Source& source : sources_) {
    Measurement part;
    if (!source.backend->read(tick, part)) return false;
    const auto from = channels_of(part);
    for (std::size_t i = 0; i < to.size(); ++i)
      if (source.gives[i]) *to[i] = *from[i], to[i]->value += zeros_[i];
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

std::vector<std::string> CompositeBackend::notes() const {
  std::vector<std::string> all;
  for (const Source& source : sources_)
    for (std::string& line : source.backend->notes()) all.push_back(std::move(line));
  return all;
}

}  // namespace pneuservo
