// A CAN interface of the kernel (can0, vcan0, slcan0): raw socket, filters, error frames, time stamps.
#pragma once
#include <string>

#include "can/frame.hpp"
#include "can/socket_frames.hpp"

namespace pneuservo {

class SocketCan final : public CanCarrier {
 public:
  /// Opens the interface. Throws std::runtime_error naming what is missing and the command that mends it.
  explicit SocketCan(const std::string& interface);
  ~SocketCan() override;
  SocketCan(const SocketCan&) = delete;
  SocketCan& operator=(const SocketCan&) = delete;

  void accept_only(const std::vector<std::uint32_t>& ids) override;
  void wait(std::int64_t timeout_ns) override;
  Sent send(const CanFrame& frame) noexcept override;
  bool receive(ReceivedFrame& received) noexcept override;
  std::int64_t now_ns() noexcept override;
  bool is_up() const noexcept override { return up_; }
  std::uint64_t dropped() const noexcept override { return dropped_; }
  std::string name() const override { return interface_; }

 private:
  std::string interface_;
  int socket_ = -1;
  MessageBatch batch_;
  bool up_ = true;
  std::uint64_t dropped_ = 0;
};

}  // namespace pneuservo
