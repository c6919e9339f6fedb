// A CAN interface of the kernel.
#include "can/socketcan.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "can/socket_frames.hpp"
#include "input_wait.hpp"

namespace pneuservo {

SocketCan::SocketCan(const std::string& interface) : interface_(interface) {
  socket_ = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (socket_ < 0 && errno == EAFNOSUPPORT)
    throw std::runtime_error(interface + ": this kernel has no CAN; load the module can_raw, or use slcan:DEVICE");
  if (socket_ < 0) fail_with_errno(interface, "no CAN socket");
  try {
    ifreq request{};
    if (interface.size() >= sizeof request.ifr_name)
      throw std::runtime_error(interface + ": no name of an interface: at most 15 characters");
    std::memcpy(request.ifr_name, interface.c_str(), interface.size() + 1);
    if (ioctl(socket_, SIOCGIFINDEX, &request) != 0)
      fail_with_errno(interface, "no such interface (see 'ip -br link'; 'ip link set " + interface +
                                     " type can bitrate 1000000')");
    const int index = request.ifr_ifindex;
    if (ioctl(socket_, SIOCGIFFLAGS, &request) != 0) fail_with_errno(interface, "its flags cannot be read");
    if ((request.ifr_flags & IFF_UP) == 0)
      throw std::runtime_error(interface + ": the interface is down: 'ip link set " + interface + " txqueuelen 16 up'");
    const can_err_mask_t errors = CAN_ERR_TX_TIMEOUT | CAN_ERR_CRTL | CAN_ERR_ACK | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
    if (setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) != 0)
      fail_with_errno(interface, "no error frames");
    ask_for_stamps(socket_, interface);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = index;
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      fail_with_errno(interface, "the socket cannot be bound");
  } catch (...) {
    close(socket_);
    throw;
  }
}

SocketCan::~SocketCan() { close(socket_); }

void SocketCan::accept_only(const std::vector<std::uint32_t>& ids) {
  std::vector<can_filter> filters;
  for (const std::uint32_t id : ids) filters.push_back({id, CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG});
  if (setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                 static_cast<socklen_t>(filters.size() * sizeof(can_filter))) != 0)
    fail_with_errno(interface_, "the receive filters were refused");
}

void SocketCan::wait(std::int64_t timeout_ns) { wait_for_input(socket_, timeout_ns); }

Sent SocketCan::send(const CanFrame& frame) noexcept {
  const Sent sent = send_message(socket_, frame);
  if (sent == Sent::down) up_ = false;
  return sent;
}

bool SocketCan::receive(ReceivedFrame& received) noexcept {
  const SocketMessage message = batch_.next(socket_);
  if (message.dropped >= 0) dropped_ = static_cast<std::uint64_t>(message.dropped);
  // ENETDOWN is told once when the interface is taken down.
  if (message.kind == SocketMessage::Kind::down || message.kind == SocketMessage::Kind::closed) up_ = false;
  if (message.kind != SocketMessage::Kind::frame) return false;
  received = {message.frame, message.received_ns};
  return true;
}

std::int64_t SocketCan::now_ns() noexcept { return monotonic_ns(); }

}  // namespace pneuservo
