// The nodes of a bus that one controller holds.
#include "can/bus_lock.hpp"

#include <filesystem>

#include <fmt/format.h>

namespace pneuservo {
namespace {

/// One name for one bus, however its path is written.
std::string plain_name(const std::string& interface) {
  const std::size_t colon = interface.find(':');
  if (colon == std::string::npos) return interface;
  std::error_code error;
  const auto path = std::filesystem::weakly_canonical(interface.substr(colon + 1), error);
  return interface.substr(0, colon + 1) + (error ? interface.substr(colon + 1) : path.string());
}

}  // namespace

BusLock::BusLock(const CanBusParameters& bus) {
  for (const auto& [name, node] : bus.nodes)
    locks_.push_back(std::make_unique<NameLock>(fmt::format("can {} {}", plain_name(bus.interface), node.node_id),
                                                fmt::format("{}: node {} ({})", bus.interface, name, node.node_id)));
}

}  // namespace pneuservo
