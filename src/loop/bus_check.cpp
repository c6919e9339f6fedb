// Grading the kernel's CAN interface: one netlink question (rtnetlink(7), linux/can/netlink.h) and its answer's grades.
#include "loop/bus_check.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
// Before the kernel's headers, which then leave out what it declares too.
#include <net/if.h>

#include <linux/can/netlink.h>
#include <linux/if_arp.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <sys/socket.h>
#include <unistd.h>

namespace pneuservo {
namespace {

using Level = FindingLevel;

/// Calls visit(type, data, length) for each attribute of a netlink message's part.
template <class Visit> void each_attribute(const void* part, std::size_t length, const Visit& visit) {
  auto* attribute = static_cast<const rtattr*>(part);
  for (int left = static_cast<int>(length); RTA_OK(attribute, left); attribute = RTA_NEXT(attribute, left))
    visit(attribute->rta_type & NLA_TYPE_MASK, RTA_DATA(attribute), RTA_PAYLOAD(attribute));
}

template <class T> T copied(const void* data, std::size_t length) {
  T value{};
  std::memcpy(&value, data, std::min(length, sizeof value));
  return value;
}

void read_controller(BusInterface& found, const void* data, std::size_t length) {
  each_attribute(data, length, [&](int type, const void* value, std::size_t size) {
    if (type == IFLA_CAN_BITTIMING) found.bit_rate_bps = copied<can_bittiming>(value, size).bitrate;
    if (type == IFLA_CAN_RESTART_MS) found.restart_ms = copied<std::uint32_t>(value, size);
    if (type == IFLA_CAN_STATE) found.state = copied<std::uint32_t>(value, size);
  });
}

BusInterface read_link(const nlmsghdr* message) {
  BusInterface found;
  const auto* link = static_cast<const ifinfomsg*>(NLMSG_DATA(message));
  found.is_can = link->ifi_type == ARPHRD_CAN;
  found.is_up = (link->ifi_flags & IFF_UP) != 0;
  each_attribute(IFLA_RTA(link), IFLA_PAYLOAD(message), [&](int type, const void* data, std::size_t length) {
    if (type == IFLA_TXQLEN) found.queue_length = copied<std::uint32_t>(data, length);
    if (type == IFLA_QDISC) found.queue_discipline = static_cast<const char*>(data);
    if (type != IFLA_LINKINFO) return;
    each_attribute(data, length, [&](int inner, const void* part, std::size_t size) {
      if (inner == IFLA_INFO_DATA && found.is_can) read_controller(found, part, size);
    });
  });
  return found;
}

/// Closed however the question ends.
struct Socket {
  int fd = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
  Socket() = default;
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() {
    if (fd >= 0) close(fd);
  }
};

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

std::optional<BusInterface> read_bus_interface(const std::string& name) {
  const unsigned index = if_nametoindex(name.c_str());
  if (index == 0) return std::nullopt;
  const Socket socket;
  struct {
    nlmsghdr header{};
    ifinfomsg link{};
  } question;
  question.header.nlmsg_len = sizeof question;
  question.header.nlmsg_type = RTM_GETLINK;
  question.header.nlmsg_flags = NLM_F_REQUEST;
  question.link.ifi_index = static_cast<int>(index);
  alignas(nlmsghdr) char answer[32768];
  if (socket.fd < 0 || send(socket.fd, &question, sizeof question, 0) < 0)
    throw std::runtime_error(fmt::format("the kernel cannot be asked about {}: {}", name, std::strerror(errno)));
  const ssize_t length = recv(socket.fd, answer, sizeof answer, 0);
  const auto* message = reinterpret_cast<const nlmsghdr*>(answer);
  if (length < 0 || !NLMSG_OK(message, static_cast<std::size_t>(length)) || message->nlmsg_type != RTM_NEWLINK)
    throw std::runtime_error(fmt::format("the kernel gives no answer about {}", name));
  return read_link(message);
}

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
