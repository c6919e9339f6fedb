// What the kernel says of the network interface that stands behind a CAN bus.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace pneuservo {

/// Bit rate, restart time and state: of real CAN controllers alone.
struct BusInterface {
  bool is_can = false;
  bool is_up = false;
  std::uint32_t queue_length = 0;  ///< frames that may wait for the bus
  std::string queue_discipline;    ///< "pfifo_fast", "noqueue", ...
  std::optional<std::uint32_t> bit_rate_bps;
  std::optional<std::uint32_t> restart_ms;  ///< the kernel leaves bus-off by itself after this; 0: never
  std::optional<std::uint32_t> state;       ///< CAN_STATE_* of linux/can/netlink.h: 0 error-active ... 3 bus-off
};

}  // namespace pneuservo
