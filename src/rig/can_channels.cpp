// The section `hal` as one list of channels on the bus, and the PDOs they share.
#include "rig/can_channels.hpp"

#include <algorithm>

namespace pneuservo {

std::vector<CanChannel> can_channels(const HalParameters& hal) {
  std::vector<CanChannel> all;
  const auto add = [&]<class Keys>(std::string_view name, std::size_t channel, bool is_output,
                                   const ChannelParameters<Keys>& parameters) {
    if (!parameters.can) return;
    const auto& can = *parameters.can;
    all.push_back({std::string(name), channel, is_output, std::string(Keys::unit), can.node, can.pdo, can.object,
                   can.is_signed, can.scale, can.zero, can.lowest, can.highest});
    if (!is_output) return;
    all.back().substitute = substitute_of(can.object, can.substitute);
    if (!can.readback) return;
    CanChannel shown = all.back();
    shown.name += ".readback";
    shown.is_output = false;
    shown.is_readback = true;
    shown.pdo = can.readback->pdo;
    if (can.readback->object.word != 0) shown.object = can.readback->object;
    shown.tolerance_V = can.readback->tolerance_V;
    all.push_back(std::move(shown));
  };
  const HalChannels& c = hal.channels;
  add("x", 0, false, c.x);
  std::size_t i = 1;
  for (const auto* pressure : {&c.p1_port, &c.p2_port, &c.p1_chamber, &c.p2_chamber, &c.p_supply}) {
    add(channel_names[i], i, false, *pressure);
    ++i;
  }
  add("u", 0, true, c.u);
  add("u1", 0, true, c.u1);
  add("u2", 1, true, c.u2);
  return all;
}

std::vector<CanPdo> can_pdos(const std::vector<CanChannel>& channels) {
  std::vector<CanPdo> pdos;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const CanChannel& c = channels[i];
    auto found = std::find_if(pdos.begin(), pdos.end(), [&](const CanPdo& pdo) {
      return pdo.node == c.node && pdo.pdo == c.pdo && pdo.is_output == c.is_output;
    });
    if (found == pdos.end()) found = pdos.insert(pdos.end(), {c.node, c.pdo, c.is_output, {}, 0});
    found->signals.push_back(i);
    found->bits += c.object.bits();
  }
  return pdos;
}

}  // namespace pneuservo
