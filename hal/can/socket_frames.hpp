// Frames through a socket whose messages are struct can_frame: SocketCAN's own, or a local one that stands in for a
// bus.
#pragma once
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
