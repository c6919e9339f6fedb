// The section `hal` as one list of channels on the bus, and the PDOs they share.
#include "rig/can_channels.hpp"

#include <algorithm>

namespace pneuservo {

std::vector<CanChannel> can_channels(const HalParameters& hal) {
  std::vector<CanChannel> all;
  const auto add = [&]<class Keys>(std::string_view name, Signal signal, std::size_t command, bool is_output,
                                   const ChannelParameters<Keys>& parameters) {
    if (!parameters.can) return;
    const auto& can = *parameters.can;
    all.push_back({std::string(name), signal, command, is_output, std::string(Keys::unit), can.node, can.pdo,
                   can.object, can.is_signed, can.scale, can.zero, can.lowest, can.highest});
    all.back().wrap_counts = can.wrap_counts;
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
  hal.channels.for_each_input(
      [&](Signal signal, const auto& channel) { add(info(signal).name, signal, 0, false, channel); });
  hal.channels.for_each_command(
      [&](std::string_view key, std::size_t valve, const auto& channel) { add(key, Signal::x, valve, true, channel); });
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
