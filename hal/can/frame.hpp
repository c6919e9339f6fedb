// One classic CAN frame, and the narrow interface of everything that carries frames: kernel bus, serial line, socket.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pneuservo {

/// Plain data; `id` has 11 bits, or 29 where `extended`. An `error` frame is the controller's own report: its `id`
/// holds the classes of linux/can/error.h.
struct CanFrame {
  std::uint32_t id = 0;
  std::uint8_t length = 0;  ///< 0 to 8
  std::array<std::uint8_t, 8> data{};
  bool extended = false, remote = false, error = false;
};

/// A frame and when it came off the bus, on the clock of its carrier.
struct ReceivedFrame {
  CanFrame frame;
  std::int64_t received_ns = 0;
};

/// What became of a frame that was handed over.
enum class Sent { sent, queue_full, down };

/// Classes of an error frame that are looked at (linux/can/error.h).
inline constexpr std::uint32_t error_controller = 0x004, error_acknowledge = 0x020, error_bus_off = 0x040,
                               error_restarted = 0x100;

/// Carries frames. The cold calls throw std::runtime_error with one sentence; send, receive and now_ns are called in
/// the real-time loop: they never block, allocate or throw.
class CanCarrier {
 public:
  virtual ~CanCarrier() = default;

  /// Only data frames of these 11-bit identifiers need be received; error frames always are. A carrier without a filter
  /// gives all: who receives counts them, and stops after so many. Cold.
  virtual void accept_only(const std::vector<std::uint32_t>& ids) = 0;
  /// Waits until a frame can be received or the time is over. Cold.
  virtual void wait(std::int64_t timeout_ns) = 0;

  virtual Sent send(const CanFrame& frame) noexcept = 0;
  /// The oldest frame that waits. False: none does.
  virtual bool receive(ReceivedFrame& received) noexcept = 0;
  /// Clock of `received_ns`.
  virtual std::int64_t now_ns() noexcept = 0;
  /// False: the link is down (interface taken down, adapter unplugged, peer gone).
  virtual bool is_up() const noexcept = 0;
  /// Frames that the receive queue had no room for, so far.
  virtual std::uint64_t dropped() const noexcept = 0;
  virtual std::string name() const = 0;
};

}  // namespace pneuservo
