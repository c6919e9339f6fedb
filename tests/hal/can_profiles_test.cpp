// Pressure transmitters of CiA 404 and a proportional valve of CiA 408 in place of the analog module.
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "can/fluid_valve.hpp"
#include "hal/can_bench.hpp"

using namespace pneuservo;
using Catch::Contains;

namespace {

constexpr std::uint8_t pressures = 2, valve = 4;

/// Device and backend before the start.
struct Start {
  Rig rig;
  PlantDevice device;
  CanBackend backend;

  explicit Start(const std::vector<std::string>& more = {})
      : rig(can_rig(profile_sets(more))), device(rig), backend(rig, std::make_unique<DeviceBus>(device)) {}
  CanopenNode& node(std::uint8_t number) {
    for (auto& node : device.nodes())
      if (node->node() == number) return *node;
    FAIL("no node " << int(number));
    throw 0;
  }
  void start() {
    backend.configure();
    backend.activate();
  }
};

}  // namespace

TEST_CASE("a valve of CiA 408 is brought to ACTIVE and follows the command, transmitters of CiA 404 close the loop") {
  Bench bench(profile_sets());
  REQUIRE(bench.run(1500) == -1);
  CHECK(std::abs(bench.device.truth().x_m - 0.0) > 1e-3);
  for (const auto& node : bench.device.nodes())
    if (node->node() == valve) CHECK(valve_state_word(node->dictionary().number(valve_status_word, 0)) == "ACTIVE");
}

TEST_CASE("a valve that loses its master holds its hold set point, and the next start resets it") {
  Bench bench(profile_sets({"safe_output.command_V=0.1"}));
  REQUIRE(bench.run(300) == -1);
  bench.bus->advance(200'000'000);  // no heartbeat, no SYNC
  CHECK(std::abs(bench.device.command_V() - 0.1) < 1e-3);
  for (const auto& node : bench.device.nodes())
    if (node->node() == valve) CHECK(valve_state_word(node->dictionary().number(valve_status_word, 0)) == "FAULT HOLD");
  bench.backend.configure();
  bench.backend.activate();
  const std::vector<std::string> notes = bench.backend.notes();
  CHECK_THAT(notes.empty() ? "" : notes.front(),
             Contains("node valve (4): the valve was in the state FAULT HOLD and was reset"));
}

TEST_CASE("a valve that stays in a fault, or below ACTIVE, is refused with its state") {
  Start s;
  ObjectDictionary& dictionary = s.node(valve).dictionary();
  SECTION("fault") {
    s.node(valve).accept_application = nullptr;
    dictionary.set_number(valve_status_word, 0, valve_disabled);
    REQUIRE_THROWS_WITH(
        s.start(), Contains("node valve (4): the valve is in the state FAULT DISABLED (0x6041 is 0x0001) also after "
                            "its fault was reset"));
  }
  SECTION("no supply of its power stage") {
    s.node(valve).accept_application = [&](std::uint16_t index, std::uint8_t, std::uint32_t value) {
      if (index == valve_control_word)
        dictionary.set_number(valve_status_word, 0, valve_ready | (value & valve_disabled));
      return SdoAbort::none;
    };
    REQUIRE_THROWS_WITH(s.start(),
                        Contains("the valve is in the state DISABLED (0x6041 is 0x0009) after control word 0x0003, "
                                 "expected HOLD"));
  }
  SECTION("operated by hand") {
    dictionary.set_number(valve_local, 0, 1);
    REQUIRE_THROWS_WITH(s.start(), Contains("its 0x604f is 1"));
  }
}

TEST_CASE("a transmitter that states another size of its counts than the config is refused") {
  Start s;
  ObjectDictionary& dictionary = s.node(pressures).dictionary();
  SECTION("decimal digits") {
    dictionary.set_number(0x6132, 2, 3);
    REQUIRE_THROWS_WITH(s.start(), Contains("node pressures (2): it states 100 Pa a count") &&
                                       Contains("found 10 in hal.channels.p2_port.can.scale_Pa_per_count"));
  }
  SECTION("millibar, one digit: the same size") {
    dictionary.set_number(0x6131, 1, 0xFD4E0000u);
    dictionary.set_number(0x6132, 1, 1);
    REQUIRE_NOTHROW(s.start());
  }
  SECTION("a unit that is not known is told and not checked") {
    dictionary.set_number(0x6131, 3, 0x00BB0000u);
    REQUIRE_NOTHROW(s.start());
    std::string notes;
    for (const std::string& note : s.backend.notes()) notes += note;
    CHECK_THAT(notes, Contains("0x6131:3 is 0x00bb0000, a unit that is not known here"));
  }
}
