// Frames through a socket whose messages are struct can_frame.
#include "can/socket_frames.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include <linux/can.h>
#include <sys/socket.h>

#include <pneuservo/core/rt.hpp>

#include "input_wait.hpp"

namespace pneuservo {
namespace {

std::int64_t clock_ns(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

/// Both clocks at one moment.
struct Now {
  std::int64_t wall_ns = clock_ns(CLOCK_REALTIME), monotonic_ns = clock_ns(CLOCK_MONOTONIC);
};

void read_control(const msghdr& header, const Now& now, ArrivalClock& clock, SocketMessage& message) noexcept {
  for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(const_cast<msghdr*>(&header), c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SO_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
      const std::int64_t stamp_ns = static_cast<std::int64_t>(stamp.tv_sec) * 1'000'000'000 + stamp.tv_nsec;
      message.received_ns = clock.arrival_ns(stamp_ns, now.wall_ns, now.monotonic_ns);
    } else if (c->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t dropped = 0;
      std::memcpy(&dropped, CMSG_DATA(c), sizeof dropped);
      message.dropped = dropped;
    }
  }
}

}  // namespace

std::int64_t ArrivalClock::arrival_ns(std::int64_t stamp_ns, std::int64_t wall_ns, std::int64_t now_ns) noexcept {
  const std::int64_t distance_ns = wall_ns - now_ns;
  if (!has_distance_) distance_ns_ = distance_ns;
  has_distance_ = true;
  const auto off_ns = [&](std::int64_t at_ns) {
    return std::max({empty_ns_ - at_ns, at_ns - now_ns, std::int64_t{0}});
  };
  if (off_ns(stamp_ns - distance_ns) <= off_ns(stamp_ns - distance_ns_)) distance_ns_ = distance_ns;
  return std::min(stamp_ns - distance_ns_, now_ns);
}

can_frame to_kernel(const CanFrame& frame) noexcept {
  can_frame out{};
  out.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0u) | (frame.remote ? CAN_RTR_FLAG : 0u) |
               (frame.error ? CAN_ERR_FLAG : 0u);
  out.can_dlc = frame.length;
  std::copy(frame.data.begin(), frame.data.end(), out.data);
  return out;
}

CanFrame from_kernel(const can_frame& in) noexcept {
  CanFrame frame;
  frame.extended = (in.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (in.can_id & CAN_RTR_FLAG) != 0;
  frame.error = (in.can_id & CAN_ERR_FLAG) != 0;
  frame.id = in.can_id & (frame.extended || frame.error ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.length = std::min<std::uint8_t>(in.can_dlc, 8);
  std::copy(std::begin(in.data), std::end(in.data), frame.data.begin());
  return frame;
}

void ask_for_stamps(int socket, const std::string& name) {
  const int on = 1;
  if (setsockopt(socket, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) != 0)
    fail_with_errno(name, "no receive time stamps");
  // Not every kind of socket counts its drops; where it does not, the counter stays 0.
  setsockopt(socket, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
}

namespace {

/// Where the kernel puts one message.
struct Slot {
  can_frame frame{};
  iovec part{};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t)) + 64];

  void prepare(msghdr& header) noexcept {
    part = {&frame, sizeof frame};
    header = {};
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    header.msg_control = control;
    header.msg_controllen = sizeof control;
  }
};

static_assert(EAGAIN == EWOULDBLOCK);
bool is_no_news(int reason) noexcept { return reason == EAGAIN || reason == EINTR; }

SocketMessage message_of(const Slot& slot, const msghdr& header, ssize_t length, const Now& now,
                         ArrivalClock& clock) noexcept {
  SocketMessage message;
  if (length == static_cast<ssize_t>(sizeof slot.frame)) {
    message.kind = SocketMessage::Kind::frame;
    message.frame = from_kernel(slot.frame);
    message.received_ns = now.monotonic_ns;
    read_control(header, now, clock, message);
  } else if (length == 0) {
    message.kind = SocketMessage::Kind::closed;
  }
  return message;
}

}  // namespace

void MessageBatch::fill(int socket) noexcept {
  std::array<Slot, most> slots;
  std::array<mmsghdr, most> headers;
  for (std::size_t i = 0; i < most; ++i) slots[i].prepare(headers[i].msg_hdr);
  int got = 0;
  clock_.begin(monotonic_ns());
  {
    const RtAllow reviewed;  // does not block
    got = recvmmsg(socket, headers.data(), most, MSG_DONTWAIT, nullptr);
  }
  next_ = count_ = 0;
  if (got < 0 && !is_no_news(errno)) messages_[count_++].kind = SocketMessage::Kind::down;
  const Now now;
  for (int i = 0; i < got; ++i) {
    const auto k = static_cast<std::size_t>(i);
    messages_[count_++] =
        message_of(slots[k], headers[k].msg_hdr, static_cast<ssize_t>(headers[k].msg_len), now, clock_);
  }
  if (count_ < most) clock_.emptied();
}

SocketMessage MessageBatch::next(int socket) noexcept {
  if (next_ == count_) {
    const bool was_partial = count_ > 0 && count_ < most;
    if (was_partial) {
      next_ = count_ = 0;
      return {};
    }
    fill(socket);
  }
  return next_ < count_ ? messages_[next_++] : SocketMessage{};
}

Sent send_message(int socket, const CanFrame& frame) noexcept {
  const can_frame out = to_kernel(frame);
  const RtAllow reviewed;  // does not block
  const ssize_t put = send(socket, &out, sizeof out, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (put == static_cast<ssize_t>(sizeof out)) return Sent::sent;
  return put < 0 && (errno == ENOBUFS || errno == EAGAIN || errno == EWOULDBLOCK) ? Sent::queue_full : Sent::down;
}

void fail_with_errno(const std::string& name, const std::string& what) {
  const int reason = errno;
  throw std::runtime_error(name + ": " + what + ": " + std::strerror(reason));
}

}  // namespace pneuservo
