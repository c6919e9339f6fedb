// Frames through a socket whose messages are struct can_frame: SocketCAN's own, or a local one that stands in for a
// bus.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "can/frame.hpp"

struct can_frame;

namespace pneuservo {

/// The kernel's form of a frame and ours.
can_frame to_kernel(const CanFrame& frame) noexcept;
CanFrame from_kernel(const can_frame& frame) noexcept;

/// One message with its kernel time stamp and the queue's drop counter.
struct SocketMessage {
  enum class Kind { frame, nothing, closed, down } kind = Kind::nothing;
  CanFrame frame;
  std::int64_t received_ns = 0;    ///< on CLOCK_MONOTONIC
  std::int64_t dropped = -1;       ///< SO_RXQ_OVFL; -1: not stated
};

/// Takes the waiting messages of a socket by one system call for up to 16 of them.
class MessageBatch {
 public:
  /// The oldest message; `nothing` where none waits. Never blocks. A batch that did not fill has emptied the queue: the
  /// `nothing` after it needs no call.
  SocketMessage next(int socket) noexcept;

 private:
  void fill(int socket) noexcept;

  static constexpr std::size_t most = 16;
  std::array<SocketMessage, most> messages_;
  std::size_t count_ = 0, next_ = 0;
};

/// Asks the kernel for time stamps and the drop counter. Throws std::runtime_error.
void ask_for_stamps(int socket, const std::string& name);
/// Never blocks.
SocketMessage receive_message(int socket) noexcept;
Sent send_message(int socket, const CanFrame& frame) noexcept;
std::int64_t monotonic_ns() noexcept;
/// Waits for input at most so long.
void wait_for_input(int file, std::int64_t timeout_ns);
/// "NAME: WHAT: reason of errno".
[[noreturn]] void fail_with_errno(const std::string& name, const std::string& what);

}  // namespace pneuservo
