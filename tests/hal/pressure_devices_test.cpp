// A pressure rig behind devices: a proportional valve or two coils on a bus, coils on digital lines, what a config of
// them can get wrong.
#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pneuservo/loop/pressure_loop.hpp>

#include "can/can_backend.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "gpio/gpio_backend.hpp"
#include "hal/device_bus.hpp"

using namespace pneuservo;

namespace {

const std::string bus_of_pressure =
    "{can: {interface: can0, watchdog_s: 0.06, nodes: {io: {node_id: 2, profile: 401, mapping: write, heartbeat_s: "
    "0.02}}}, channels: {p1_port: {can: {node: io, pdo: 2, object: 0x64010110, scale_Pa_per_count: 25, lowest_Pa: "
    "50000, "
    "highest_Pa: 810000}}, p_supply: {can: {node: io, pdo: 2, object: 0x64010310, scale_Pa_per_count: 25, lowest_Pa: "
    "50000, highest_Pa: 810000}}, ";

std::string output_on_bus(const std::string& name, int number, double lowest_V, double highest_V) {
  return name + ": {can: {node: io, pdo: 2, object: 0x64110" + std::to_string(number) +
         "10, scale_V_per_count: 0.001, lowest_V: " + std::to_string(lowest_V) +
         ", highest_V: " + std::to_string(highest_V) + "}}";
}

Rig pressure_rig(const std::string& config, const std::string& channels, const std::vector<std::string>& more = {}) {
  std::vector<std::string> sets{"hal=" + bus_of_pressure + channels + "}}"};
  sets.insert(sets.end(), more.begin(), more.end());
  return read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/" + config + ".yaml", sets);
}

Rig coils_on_lines(const std::vector<std::string>& sets = {}) {
  return read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/mixed/pressure-on-off-3m-4mm.yaml", sets);
}

std::string refusal_of_lines(const std::string& set) {
  try {
    coils_on_lines({set});
  } catch (const InputError& error) { return error.what(); }
  return "accepted";
}

/// The loop on the simulated device of the bus, a period a tick.
struct PressureBench {
  Rig rig;
  PlantDevice device;
  DeviceBus* bus = nullptr;
  CanBackend backend;
  PressureLoop loop;

  explicit PressureBench(const Rig& config) : rig(config), device(rig), backend(rig, made()) {
    loop.configure(rig);
    backend.configure();
    backend.activate();
  }
  std::unique_ptr<CanCarrier> made() {
    auto one = std::make_unique<DeviceBus>(device);
    bus = one.get();
    return one;
  }
  void run(double duration_s) {
    for (std::int64_t tick = 0; static_cast<double>(tick) * rig.period_s < duration_s; ++tick) {
      loop.pass(backend, tick, 0, nullptr, nullptr);
      bus->advance(std::llround(rig.period_s * 1e9));
    }
  }
};

class CoilLine final : public GpioLine {
 public:
  explicit CoilLine(bool& level) : level_(level) {}
  std::optional<bool> read() noexcept override { return level_; }
  bool write(bool active) noexcept override {
    level_ = active;
    return true;
  }
  Edges take_edges() noexcept override { return {}; }

 private:
  bool& level_;
};

}  // namespace

TEST_CASE("a pressure rig over a bus: a proportional valve, and two on/off valves by an output each") {
  const std::vector<std::pair<std::string, std::string>> rigs{
      {"pressure-3m-4mm", output_on_bus("u", 1, -5, 5)},
      {"pressure-on-off-3m-4mm", output_on_bus("u1", 1, 0, 24) + ", " + output_on_bus("u2", 2, 0, 24)}};
  for (const auto& [config, channels] : rigs) {
    INFO(config);
    PressureBench bench(pressure_rig(config, channels));
    bench.run(2.9);  // the first step, settled
    CHECK(bench.loop.faults() == 0);
    CHECK(bench.loop.row().p_ref_Pa == 4e5);
    CHECK(bench.loop.row().measured[Signal::p1_port] == Approx(4e5).margin(1e4));
    CHECK(bench.loop.row().p1_estimated_Pa == Approx(4e5).margin(5e3));
  }
}

TEST_CASE("coils on digital lines: one at a time, none at rest and at the end, the one that empties where it vents") {
  for (const std::string action : {"hold", "vent"}) {
    INFO(action);
    std::map<std::string, bool> level;
    GpioBackend backend(coils_on_lines({"safe_output.action=" + action}),
                        [&](const std::string& key, const GpioLineParameters&, bool is_output) {
                          REQUIRE(is_output);
                          return std::make_unique<CoilLine>(level[key]);
                        });
    const auto powers = [&] { return std::pair{level.at("u1"), level.at("u2")}; };
    const std::pair<bool, bool> safe{false, action == "vent"};
    backend.configure();
    CHECK(powers() == std::pair{false, false});
    backend.activate();
    CHECK(powers() == safe);
    REQUIRE(backend.write(0, {24.0, 24.0, true}));
    CHECK(powers() == std::pair{true, false});
    REQUIRE(backend.write(1, {-24.0, -24.0, true}));
    CHECK(powers() == std::pair{false, true});
    REQUIRE(backend.write(2, {0.0, 0.0, true}));
    CHECK(powers() == std::pair{false, false});
    REQUIRE(backend.write(3, {std::nan(""), std::nan(""), true}));
    CHECK(powers() == std::pair{false, false});
    backend.write(4, {24.0, 24.0, true});
    CHECK(backend.emergency_write());
    CHECK(powers() == safe);
    level["u1"] = true;  // a line that was set when the loop died, before it was noted
    level["u2"] = !safe.second;
    CHECK(backend.emergency_write());
    CHECK(powers() == safe);
    CHECK(backend.origins().command == Origin::real);
    CHECK(backend.safe_output().has_outputs);
    backend.deactivate();
    CHECK(powers() == safe);
  }
}

TEST_CASE("devices of a pressure rig: what a config can get wrong is named by its key") {
  CHECK_THAT(refusal_of_lines("hal.channels.x={simulated: true}"),
             Catch::Contains("hal.channels.x: found a channel") && Catch::Contains("pressure has no position"));
  CHECK_THAT(refusal_of_lines("hal.channels.u={simulated: true}"),
             Catch::Contains("hal.channels.u: found a command u"));
  CHECK_THAT(refusal_of_lines("hal.channels.u2={}"), Catch::Contains("hal.channels.u2: found nothing"));
  CHECK_THAT(refusal_of_lines("hal.channels.p1_port={}"), Catch::Contains("hal.channels.p1_port: found nothing"));
  CHECK_THAT(refusal_of_lines("hal.channels.u2.gpio.line=4"), Catch::Contains("a second time"));
  CHECK_THAT(refusal_of_lines("hal.gpio={}"), Catch::Contains("hal.gpio.watchdog"));
  CHECK_THAT(refusal_of_lines("hal.gpio.watchdog=enable_line"), Catch::Contains("without hal.gpio.enable"));
  CHECK_THAT(refusal_of_lines("zeros={x: 0.1}"), Catch::Contains("zeros.x: found no channel of this rig"));
  CHECK_THROWS_WITH(pressure_rig("pressure-3m-4mm", output_on_bus("u1", 1, -5, 5)),
                    Catch::Contains("hal.channels.u1: found a command u1") && Catch::Contains("u, the one valve"));
  CHECK_THROWS_WITH(pressure_rig("pressure-on-off-3m-4mm",
                                 output_on_bus("u1", 1, 0, 24) + ", " + output_on_bus("u2", 2, 0, 24),
                                 {"hal.channels.u1={gpio: {chip: gpiochip0, line: \"4\"}}"}),
                    Catch::Contains("without hal.gpio"));
}
