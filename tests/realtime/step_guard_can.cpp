// The CAN backend's tick under system call trap, allocation count and fault count: a device in a thread of its own,
// real frames through a local socket. Status 1 if anything but the reviewed sends and receives was caught.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include <pneuservo/core/rt.hpp>

#include "can/can_backend.hpp"
#include "can/local_bus.hpp"
#include "can/plant_device.hpp"
#include "config/read_rig.hpp"
#include "loop/realtime.hpp"
#include "step_guard.hpp"

using namespace pneuservo;

namespace {

void serve(PlantDevice& device, LocalBus& bus, const std::atomic<bool>& stop) {
  std::vector<CanFrame> out;
  const auto flush = [&] {
    for (const CanFrame& frame : out) bus.send(frame);
    out.clear();
  };
  while (!stop) {
    bus.wait(1'000'000);
    for (ReceivedFrame received; bus.receive(received); flush()) device.on_frame(received, out);
    device.on_time(bus.now_ns(), out);
    flush();
  }
}

}  // namespace

int main() {
  std::string folder = (std::filesystem::temp_directory_path() / "pneuservo-can-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) return 1;
  const std::string path = folder + "/bus";
  const std::string interface = "hal.can.interface=unix:" + path;
  // Slow heartbeats and a slow period: a loaded machine may hold the device's thread.
  const Rig rig = read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/can/cylinder-10m-7.65mm.yaml",
                           {interface, "period_s=0.1", "hal.can.heartbeat_s=0.5", "hal.can.watchdog_s=10",
                            "hal.can.nodes.io.heartbeat_s=1", "hal.can.nodes.encoder.heartbeat_s=1"});
  PlantDevice device(rig);
  LocalBus bus(path, LocalBus::Side::listens);
  std::atomic<bool> stop = false;
  std::thread thread([&] { serve(device, bus, stop); });
  int status = 1;
  try {
    CanBackend backend(rig);
    backend.configure();
    backend.activate();
    const RealTimeSession session;
    std::int64_t tick = 0, valid = 0;
    const auto step = [&] {
      {
        const RtScope hot;
        Measurement m;
        backend.read(tick, m);
        backend.write(tick++, {0.1});
        valid += m.channel[Signal::x].valid ? 1 : 0;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
    const StepGuardReport report = guard_steps(step, 50, 1000);
    const std::string violations = report.violations();
    std::fprintf(stderr, "can, %ld of %ld samples: %s\n", static_cast<long>(valid), static_cast<long>(tick),
                 violations.empty() ? "nothing caught" : violations.c_str());
    status = violations.empty() && valid > 0 ? 0 : 1;
  } catch (const std::exception& error) { std::fprintf(stderr, "%s\n", error.what()); }
  stop = true;
  thread.join();
  std::filesystem::remove_all(folder);
  return status;
}
