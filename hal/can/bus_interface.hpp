// Asks the kernel about a CAN interface.
#pragma once
#include <optional>
#include <string>

#include <pneuservo/hal/bus_interface.hpp>

namespace pneuservo {

/// None if there is no such interface. Throws std::runtime_error where the kernel cannot be asked.
std::optional<BusInterface> read_bus_interface(const std::string& name);

}  // namespace pneuservo
