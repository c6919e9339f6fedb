// A controller's loop on the simulated device, over the bus of one thread: a period a tick, no clock of the machine.
#pragma once
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/loop/axis_loop.hpp>

#include "can/can_backend.hpp"
#include "config/read_rig.hpp"
#include "hal/device_bus.hpp"

namespace pneuservo {

inline Rig can_rig(const std::vector<std::string>& sets = {}) {
  return read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/can/cylinder-10m-7.65mm.yaml", sets);
}

/// A device, the bus, the backend and a loop on it; a period a tick.
struct Bench {
  Rig rig;
  PlantDevice device;
  DeviceBus* bus;
  CanBackend backend;
  AxisLoop loop;
  std::int64_t tick = 0, period_ns;

  explicit Bench(const std::vector<std::string>& sets = {}, const std::vector<std::string>& faults = {})
      : rig(can_rig(sets)), device(rig), bus(nullptr), backend(rig, make_bus()),
        period_ns(std::llround(rig.period_s * 1e9)) {
    for (const std::string& fault : faults) device.add_fault(parse_fault_order(fault, 0.0));
    loop.configure(rig);
    backend.configure();
    backend.activate();
    bus->sent.clear();
  }
  std::unique_ptr<CanCarrier> make_bus() {
    auto made = std::make_unique<DeviceBus>(device);
    bus = made.get();
    return made;
  }
  void step() {
    loop.pass(backend, tick++, 0, nullptr, nullptr);
    bus->advance(period_ns);
  }
  /// Tick of the first fault; -1 where there was none.
  std::int64_t run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      step();
      if (loop.faults() != 0) return tick - 1;
    }
    return -1;
  }
};

}  // namespace pneuservo
