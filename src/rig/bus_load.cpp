// Time that the frames of a config take on a classic CAN bus.
#include "rig/bus_load.hpp"

#include <cmath>

#include <fmt/format.h>

#include "rig/can_channels.hpp"

namespace pneuservo {

BusLoad bus_load(const Rig& rig) {
  BusLoad load;
  if (!rig.hal || !rig.hal->can) return load;
  const CanBusParameters& bus = *rig.hal->can;
  const auto add = [&](std::string name, int bytes, double per_period) {
    const double worst_s = can_frame_bits_worst(bytes) / bus.bit_rate_bps;
    load.frames.push_back({std::move(name), bytes, per_period, worst_s});
    load.share += per_period * worst_s / rig.period_s;
    load.longest_period_s += std::ceil(per_period) * worst_s;
  };
  add("SYNC", 0, 1.0);
  for (const CanPdo& pdo : can_pdos(can_channels(*rig.hal))) {
    const auto node = bus.nodes.find(pdo.node);
    const bool own = node != bus.nodes.end() && node->second.mapping == CanMapping::read;
    const int bytes = own ? 8 : static_cast<int>((pdo.bits + 7) / 8);
    add(fmt::format("{} {}{}", pdo.node, pdo.is_output ? "RPDO" : "TPDO", pdo.pdo), bytes, 1.0);
  }
  for (const auto& [name, node] : bus.nodes) add(name + " heartbeat", 1, rig.period_s / node.heartbeat_s);
  add("own heartbeat", 1, rig.period_s / std::max(bus.heartbeat_s, rig.period_s));
  return load;
}

std::string bus_load_text(const BusLoad& load, double period_s) {
  std::string text;
  for (const BusFrame& frame : load.frames)
    if (frame.per_period >= 1.0)
      text += fmt::format("{}{} {:.0f} us", text.empty() ? "" : ", ", frame.name, frame.worst_s * 1e6);
  return fmt::format("{:.1f} % of {:g} ms with the worst stuffing ({}, and heartbeats)", 100.0 * load.share,
                     period_s * 1e3, text);
}

}  // namespace pneuservo
