// One netlink question about an interface (rtnetlink(7), linux/can/netlink.h) and its answer.
#include "can/bus_interface.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

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

/// Calls visit(type, data, length) for each attribute of a netlink message's part.
template <class Visit> void each_attribute(const void* part, std::size_t length, const Visit& visit) {
  const char* at = static_cast<const char*>(part);
  while (length >= sizeof(rtattr)) {
    const auto* attribute = reinterpret_cast<const rtattr*>(at);
    if (attribute->rta_len < sizeof(rtattr) || attribute->rta_len > length) return;
    visit(attribute->rta_type & NLA_TYPE_MASK, RTA_DATA(attribute), RTA_PAYLOAD(attribute));
    const std::size_t step = std::min<std::size_t>(RTA_ALIGN(attribute->rta_len), length);
    at += step;
    length -= step;
  }
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
  const void* attributes = reinterpret_cast<const char*>(link) + NLMSG_ALIGN(sizeof(ifinfomsg));
  each_attribute(attributes, IFLA_PAYLOAD(message), [&](int type, const void* data, std::size_t length) {
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
  const bool is_whole = length >= 0 && NLMSG_OK(message, static_cast<std::size_t>(length));
  if (!is_whole || message->nlmsg_type != RTM_NEWLINK)
    throw std::runtime_error(fmt::format("the kernel gives no answer about {}", name));
  return read_link(message);
}

}  // namespace pneuservo
