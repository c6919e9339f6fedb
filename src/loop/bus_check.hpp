// Grading the kernel's CAN interface that a config names: there, up, at the config's bit rate, with a short queue.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "loop/finding.hpp"

namespace pneuservo {

/// What the kernel says of a network interface. Bit rate, restart time and state: of real CAN controllers alone.
struct BusInterface {
  bool is_can = false;
  bool is_up = false;
  std::uint32_t queue_length = 0;  ///< frames that may wait for the bus
  std::string queue_discipline;    ///< "pfifo_fast", "noqueue", ...
  std::optional<std::uint32_t> bit_rate_bps;
  std::optional<std::uint32_t> restart_ms;  ///< the kernel leaves bus-off by itself after this; 0: never
  std::optional<std::uint32_t> state;       ///< CAN_STATE_* of linux/can/netlink.h: 0 error-active ... 3 bus-off
};

/// Asks the kernel; none if there is no such interface. Throws std::runtime_error where the kernel cannot be asked.
std::optional<BusInterface> read_bus_interface(const std::string& name);

/// Grades it for a loop that sends the newest command or none. `found`: of read_bus_interface.
std::vector<Finding> grade_bus_interface(const std::string& name, const std::optional<BusInterface>& found,
                                         double bit_rate_bps);

}  // namespace pneuservo
