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

/// The kernel stamps frames with the wall clock, which may be set at any moment. A frame came after the queue was last
/// empty and not after now: of the clocks' distance now and the one that held last, the one that says so is taken.
class ArrivalClock {
 public:
  /// Before a call that may take messages; `wall_ns` and `now_ns` are read after it, see arrival_ns.
  void begin(std::int64_t now_ns) noexcept { begun_ns_ = now_ns; }
  /// Of a message on the monotonic clock.
  std::int64_t arrival_ns(std::int64_t stamp_ns, std::int64_t wall_ns, std::int64_t now_ns) noexcept;
  /// The call left nothing in the queue.
  void emptied() noexcept { empty_ns_ = begun_ns_; }

 private:
  std::int64_t begun_ns_ = 0, empty_ns_ = 0, distance_ns_ = 0;
  bool has_distance_ = false;
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
  ArrivalClock clock_;
  std::array<SocketMessage, most> messages_;
  std::size_t count_ = 0, next_ = 0;
};

/// Asks the kernel for time stamps and the drop counter. Throws std::runtime_error.
void ask_for_stamps(int socket, const std::string& name);
/// Never blocks.
Sent send_message(int socket, const CanFrame& frame) noexcept;
/// "NAME: WHAT: reason of errno".
[[noreturn]] void fail_with_errno(const std::string& name, const std::string& what);

}  // namespace pneuservo
