// Grades of what the kernel says of a CAN interface.
#include "loop/bus_check.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

namespace pneuservo {
namespace {

using Level = FindingLevel;

Finding queue_finding(const std::string& name, const BusInterface& found) {
  // Without a queue (vcan) nothing waits. The driver refuses what does not fit, and the loop counts it as missed.
  constexpr std::uint32_t longest_queue = 32;
  static constexpr std::string_view plain[]{"pfifo_fast", "pfifo", "noqueue", "noop", "mq"};
  const bool is_plain = std::find(std::begin(plain), std::end(plain), found.queue_discipline) != std::end(plain);
  if (!is_plain)
    return {Level::acceptable, "CAN queue",
            fmt::format("discipline {}: it may delay, drop or reorder commands", found.queue_discipline),
            fmt::format("tc qdisc replace dev {} root pfifo_fast", name)};
  if (found.queue_discipline != "noqueue" && found.queue_length > longest_queue)
    return {Level::acceptable, "CAN queue",
            fmt::format("{} frames long: on a jammed bus old commands wait in it", found.queue_length),
            fmt::format("ip link set {} txqueuelen 16", name)};
  return {Level::good, "CAN queue", fmt::format("{}, {} frames", found.queue_discipline, found.queue_length), ""};
}

void grade_controller(std::vector<Finding>& findings, const std::string& name, const BusInterface& found,
                      double bit_rate_bps) {
  const auto set_up = fmt::format("ip link set {0} down; ip link set {0} type can bitrate {1:.0f} restart-ms 0; "
                                  "ip link set {0} up",
                                  name, bit_rate_bps);
  if (found.bit_rate_bps) {
    const bool same = static_cast<double>(*found.bit_rate_bps) == bit_rate_bps;
    findings.push_back({same ? Level::good : Level::bad, "CAN bit rate",
                        same ? fmt::format("{} bit/s", *found.bit_rate_bps)
                             : fmt::format("{} bit/s, the config has {:.0f}", *found.bit_rate_bps, bit_rate_bps),
                        same ? "" : set_up});
  }
  if (found.restart_ms)
    findings.push_back({*found.restart_ms == 0 ? Level::good : Level::acceptable, "CAN bus-off",
                        *found.restart_ms == 0 ? "the controller stays off until a person has looked"
                                               : fmt::format("the kernel restarts the controller after {} ms by itself",
                                                             *found.restart_ms),
                        *found.restart_ms == 0 ? "" : set_up});
  static constexpr const char* states[]{"error-active", "error-warning", "error-passive",
                                        "bus-off",      "stopped",       "sleeping"};
  if (found.state && *found.state < std::size(states)) {
    const Level level = *found.state == 0 ? Level::good : *found.state <= 2 ? Level::acceptable : Level::bad;
    findings.push_back({level, "CAN controller", states[*found.state],
                        level == Level::good ? "" : "mend wiring, termination or bit rate; then " + set_up});
  }
}

}  // namespace

std::vector<Finding> grade_bus_interface(const std::string& name, const std::optional<BusInterface>& found,
                                         double bit_rate_bps) {
  if (!found)
    return {{Level::bad, "CAN interface", fmt::format("there is no interface {}", name),
             "plug the adapter in and load its driver; `ip -br link` lists the interfaces"}};
  if (!found->is_can)
    return {{Level::bad, "CAN interface", fmt::format("{} is no CAN interface", name),
             "name one in hal.can.interface; `ip -br link show type can` lists them"}};
  std::vector<Finding> findings;
  findings.push_back({found->is_up ? Level::good : Level::bad, "CAN interface",
                      fmt::format("{} is {}", name, found->is_up ? "up" : "down"),
                      found->is_up ? "" : fmt::format("ip link set {} up", name)});
  findings.push_back(queue_finding(name, *found));
  grade_controller(findings, name, *found, bit_rate_bps);
  return findings;
}

}  // namespace pneuservo
