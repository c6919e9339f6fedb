// The nodes of a bus that one controller holds.
#pragma once
#include <memory>
#include <vector>

#include <pneuservo/rig/hal_parameters.hpp>

#include "device_lock.hpp"

namespace pneuservo {

/// Held while it lives: two controllers on one interface with a node in common are refused. Throws std::runtime_error
/// with the process that has it.
class BusLock {
 public:
  explicit BusLock(const CanBusParameters& bus);

 private:
  std::vector<std::unique_ptr<NameLock>> locks_;
};

}  // namespace pneuservo
