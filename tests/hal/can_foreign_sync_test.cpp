// The loop locked to another master's SYNC: what a tick sees, when its command acts, and what a SYNC that is missing
// does.
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "hal/habit_bench.hpp"

using namespace pneuservo;
using namespace pneuservo::habits;
using Catch::Contains;

namespace {

/// The simulated device is the other master; the loop runs as run_real has it.
struct Locked : Habit {
  AxisLoop loop;
  std::int64_t tick = 0;

  explicit Locked(const std::vector<std::string>& sets = {}) : Habit(with_sync(sets)) {
    loop.configure(rig);
    start();
    bus->sent.clear();
  }
  static std::vector<std::string> with_sync(std::vector<std::string> sets) {
    sets.emplace_back("hal.can.sync=foreign");
    return sets;
  }
  std::int64_t samples = 0;  // of the last tick
  void step() {
    samples = backend.await_sample().samples;
    const std::int64_t skipped = std::max<std::int64_t>(samples - 1, 0);
    tick += skipped;
    loop.pass(backend, tick++, skipped, nullptr, nullptr);
  }
  int sent_syncs() const {
    int count = 0;
    for (const CanFrame& frame : bus->sent) count += is_sync(frame) ? 1 : 0;
    return count;
  }
};

}  // namespace

TEST_CASE("locked to a foreign SYNC each tick has the sample of its own SYNC, and sends none") {
  Locked l;
  const std::int64_t syncs = l.device.syncs();
  for (int i = 0; i < 1000; ++i) {
    l.step();
    REQUIRE(l.samples == 1);
    // The device has sampled the plant at this very SYNC.
    REQUIRE(std::abs(l.loop.row().measured[Signal::x] - l.device.truth().x_m) < 1e-5);
  }
  CHECK(l.loop.faults() == 0);
  CHECK(l.device.syncs() - syncs <= 1001);
  CHECK(l.sent_syncs() == 0);
  CHECK(std::abs(l.device.truth().x_m) > 1e-3);
}

TEST_CASE("a command acts at the next foreign SYNC: one period after its sample") {
  Locked l;
  for (int i = 0; i < 400; ++i) {
    const double before_V = l.loop.row().u_V;
    l.step();
    // What the valve has had since this tick's SYNC is the command of the tick before, as its 16 bits have it.
    if (i > 0) REQUIRE(std::abs(l.device.command_V() - before_V) < 3.1e-4);
  }
  CHECK(l.loop.faults() == 0);
}

TEST_CASE("a tick that was slept through is an overrun, and the next one has the newest sample") {
  Locked l;
  for (int i = 0; i < 50; ++i) l.step();
  l.bus->advance(3'400'000);
  l.step();
  CHECK(l.samples >= 3);
  CHECK(std::abs(l.loop.row().measured[Signal::x] - l.device.truth().x_m) < 1e-5);
  l.step();
  CHECK(l.samples == 1);
  CHECK(l.loop.faults() == 0);
}

TEST_CASE("a foreign SYNC that stops is a fault after its time-out, and the safe output acts by our own") {
  Locked l({"hal.can.sync_timeout_s=0.004"});
  for (int i = 0; i < 300; ++i) l.step();
  REQUIRE(l.loop.faults() == 0);
  REQUIRE(std::abs(l.device.command_V()) > 1e-3);
  l.device.sends_sync = false;
  const std::int64_t stopped_ns = l.bus->now;
  l.step();
  CHECK((l.loop.faults() & fault_node_lost) != 0);
  CHECK(l.samples == 0);
  CHECK(l.bus->now - stopped_ns <= 5'000'000);
  CHECK(l.device.command_V() == 0.0);
  CHECK(l.sent_syncs() == 1);
  // It goes on by its own clock: the sensors still tell what the axis does.
  const std::int64_t lost_ns = l.bus->now;
  for (int i = 0; i < 20; ++i) l.step();
  CHECK(std::abs(static_cast<double>(l.bus->now - lost_ns) - 20e6) < 6e6);
  CHECK_THAT(l.notes(), Contains("no SYNC of the master that the loop waits for"));
}

TEST_CASE("a foreign SYNC of another period is refused before motion with both periods") {
  Habit h({"hal.can.sync=foreign", "period_s=0.002"});
  Habit other({"hal.can.sync=foreign"});
  // The bus of a device of 1 ms under a controller of 2 ms.
  auto bus = std::make_unique<DeviceBus>(other.device);
  CanBackend backend(h.rig, std::move(bus));
  REQUIRE_THROWS_WITH(backend.configure(), Contains("found a SYNC every 0.001 s, expected one every 0.002 s"));
}
