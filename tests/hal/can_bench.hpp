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

/// Transmitters of CiA 404 and a valve of CiA 408 in place of the analog module.
inline std::vector<std::string> profile_sets(const std::vector<std::string>& more = {}) {
  const std::string eds = std::string(PNEUSERVO_SOURCE_DIR) + "/config/can/";
  std::vector<std::string> sets{
      "hal.can.nodes={pressures: {node_id: 2, profile: 404, eds: " + eds +
          "pressure-transmitter-404.eds}, encoder: {node_id: 3, profile: 406, mapping: read}, valve: {node_id: 4, "
          "profile: 408, eds: " +
          eds + "proportional-valve-408.eds}}",
      "hal.channels.p1_port={can: {node: pressures, pdo: 1, object: 0x91300120, scale_Pa_per_count: 10, lowest_Pa: "
      "50000, highest_Pa: "
      "810000}}",
      "hal.channels.p2_port={can: {node: pressures, pdo: 1, object: 0x91300220, scale_Pa_per_count: 10, lowest_Pa: "
      "50000, highest_Pa: "
      "810000}}",
      "hal.channels.p_supply={can: {node: pressures, pdo: 2, object: 0x91300320, scale_Pa_per_count: 10, lowest_Pa: "
      "50000, "
      "highest_Pa: 810000}}",
      "hal.channels.u={can: {node: valve, pdo: 1, object: 0x63000110, scale_V_per_count: 6.103515625e-4, lowest_V: -5, "
      "highest_V: 5, "
      "readback: {pdo: 1, object: 0x63010110, tolerance_V: 0.002}}}"};
  sets.insert(sets.end(), more.begin(), more.end());
  return sets;
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
  ~Bench() { bus->let_all_pass(); }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;
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
