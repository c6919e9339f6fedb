// A serial line with a LAWICEL adapter behind it (slcan:/dev/ttyACM0), spoken to without the kernel's CAN.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "can/frame.hpp"
#include "can/slcan_codec.hpp"

namespace pneuservo {

/// Frames are stamped when they are read: later than the kernel would, by up to a period.
class SlcanLine final : public CanCarrier {
 public:
  /// Opens the line raw, closes the adapter's channel, sets the bit rate, opens it. Throws std::runtime_error.
  SlcanLine(const std::string& device, double bit_rate_bps);
  ~SlcanLine() override;
  SlcanLine(const SlcanLine&) = delete;
  SlcanLine& operator=(const SlcanLine&) = delete;

  void accept_only(const std::vector<std::uint32_t>&) override {}  // the adapter has no filter
  void wait(std::int64_t timeout_ns) override;
  Sent send(const CanFrame& frame) noexcept override;
  bool receive(ReceivedFrame& received) noexcept override;
  std::int64_t now_ns() noexcept override;
  bool is_up() const noexcept override { return up_; }
  std::uint64_t dropped() const noexcept override { return garbled_; }
  std::string name() const override { return "slcan:" + device_; }

 private:
  bool put(const char* text, std::size_t length) noexcept;
  bool finish_started() noexcept;
  bool fill() noexcept;

  std::string device_;
  int file_ = -1;
  bool up_ = true;
  SlcanLines lines_;
  std::array<char, 512> input_{};
  std::size_t next_ = 0, end_ = 0;
  SlcanText started_{};        // a text of which the line took a part only: the rest goes first
  std::size_t started_done_ = 0;
  std::uint64_t garbled_ = 0;
};

}  // namespace pneuservo
