// The ways to the safe state over a bus: the device's watchdog where commands no longer reach the valve, substitutes of
// other objects than 0x6411, the output read back, two answers in a cycle.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "core/test_seed.hpp"
#include "hal/can_bench.hpp"
#include "loop/device_grade.hpp"
#include "loop/safe_output_text.hpp"
#include "rig/injected_fault.hpp"

using namespace pneuservo;

namespace {

std::uint64_t fault_named(const std::string& name) {
  for (const FaultText& text : fault_texts)
    if (text.name == name) return text.bit;
  FAIL("no fault " << name);
  return 0;
}

/// Ticks from the fault until the valve has `safe_V`, as long as the run goes on after it.
int ticks_until_safe(Bench& b, double safe_V) {
  for (int i = 0; i < 300; ++i) {
    if (std::fabs(b.device.command_V() - safe_V) < 2e-4) return i;
    b.step();
  }
  return -1;
}

bool is_own_heartbeat(const CanFrame& frame) { return frame.id == 0x77E; }

}  // namespace

TEST_CASE("a valve that the safe output left open before the start makes no false fault") {
  const double safe_V = GENERATE(-0.5, 0.25, 1.0);
  Bench b({"safe_output.command_V=" + std::to_string(safe_V)});
  double most_m = 0.0;
  for (int i = 0; i < 700; ++i) {
    b.step();
    most_m = std::max(most_m, std::fabs(b.loop.supervisor().motion().deviation_m()));
  }
  CAPTURE(safe_V, most_m);
  CHECK(b.loop.faults() == 0);
  CHECK(most_m < 0.6 * b.loop.supervisor().motion().limits().start_deviation_m);
}

TEST_CASE(
    "where commands no longer reach the valve, NMT stop closes it in some cycles, else the watchdog in its time") {
  const int watchdog_ms = GENERATE(60, 100);
  const std::string how = GENERATE("pre_operational", "lost commands", "changed identifier");
  const bool stop_is_lost = GENERATE(false, true);
  INFO(how << ", watchdog of " << watchdog_ms << " ms" << (stop_is_lost ? ", NMT stop lost" : ""));
  Bench b({"safe_output.command_V=0.25", "hal.can.watchdog_s=" + std::to_string(watchdog_ms * 1e-3)});
  REQUIRE(b.run(730) == -1);
  if (how == "pre_operational") {
    std::vector<CanFrame> out;
    b.device.nodes()[1]->on_frame(nmt_frame(NmtCommand::enter_pre_operational, 2), b.bus->now, out);
  } else if (how == "changed identifier") {
    // Another master moves the RPDO, by the states and the SDO that CiA 301 asks for.
    auto& io = *b.device.nodes()[1];
    std::vector<CanFrame> out;
    io.on_frame(nmt_frame(NmtCommand::enter_pre_operational, 2), b.bus->now, out);
    io.dictionary().set_number(0x1401, 1, 0x3F2);
    io.on_frame(nmt_frame(NmtCommand::start, 2), b.bus->now, out);
  } else {
    b.bus->lose = [](const CanFrame& frame) { return (frame.id & 0x780) == 0x300; };
  }
  if (stop_is_lost)
    b.bus->lose = [before = b.bus->lose](const CanFrame& frame) {
      return (before && before(frame)) || (frame.id == 0 && frame.data[0] == static_cast<int>(NmtCommand::stop));
    };
  REQUIRE(b.run(60) >= 0);
  b.bus->sent.clear();
  const int ticks = ticks_until_safe(b, 0.25);
  REQUIRE(ticks >= 0);
  REQUIRE(ticks <= (stop_is_lost ? watchdog_ms + 2 : CanProcessImage::most_unconfirmed + 3));
  // The last way is silence: not one heartbeat after the fault, while SYNC goes on.
  for (int i = 0; i < 100; ++i) b.step();
  REQUIRE(std::none_of(b.bus->sent.begin(), b.bus->sent.end(), is_own_heartbeat));
  REQUIRE(std::count_if(b.bus->sent.begin(), b.bus->sent.end(), is_sync) >= 100);
  REQUIRE(b.device.nodes()[1]->is_substituted());
  const SafeOutput& safe = b.backend.safe_output();
  REQUIRE((safe.stop_tick >= 0 && safe.substitute_tick >= safe.stop_tick));
  REQUIRE_THAT(safe_output_text(safe, b.rig), Catch::Contains("told to stop (NMT)"));
}

TEST_CASE("who commands the valve in our place moves it no further than a few cycles after the fault") {
  Bench b({"safe_output.command_V=0.25"});
  REQUIRE(b.run(700) == -1);
  b.bus->rewrite = [](CanFrame& frame) {
    if (frame.id == 0x302) put_u16(frame.data.data(), 9830);  // 3 V in the same cycle, for good
  };
  REQUIRE(b.run(10) >= 0);
  const int ticks = ticks_until_safe(b, 0.25);
  REQUIRE(ticks >= 0);
  REQUIRE(ticks <= CanProcessImage::most_unconfirmed + 3);
  for (int i = 0; i < 200; ++i) b.step();
  REQUIRE(std::fabs(b.device.command_V() - 0.25) < 2e-4);  // a stopped node takes no process data
}

TEST_CASE(
    "after a fault the encoder goes on telling the position, and what the watchdog silences is no further fault") {
  Bench b({}, {"emergency:io:0x3100@0.5"});
  const std::int64_t at = b.run(1000);
  REQUIRE(at > 0);
  const std::uint64_t found = b.loop.faults();
  int positions = 0;
  for (int i = 0; i < 290; ++i) {
    b.step();
    positions += std::isfinite(b.loop.row().measured[Signal::x]);
  }
  REQUIRE(positions == 290);
  REQUIRE(b.device.nodes()[1]->state() == NmtState::pre_operational);
  REQUIRE(b.loop.faults() == found);
}

TEST_CASE("the end of a run withholds the heartbeat too, and the next start gives it again") {
  Bench b;
  REQUIRE(b.run(200) == -1);
  b.bus->sent.clear();
  b.loop.stop(b.backend, b.tick);
  b.backend.deactivate();
  REQUIRE(std::none_of(b.bus->sent.begin(), b.bus->sent.end(), is_own_heartbeat));
  b.bus->advance(70'000'000);
  REQUIRE(b.device.nodes()[1]->is_substituted());
  b.loop.rearm();
  b.backend.configure();
  b.backend.activate();
  b.tick = 0;
  REQUIRE(b.run(200) == -1);
}

TEST_CASE("the safe output is told as sent, as read back only where the device showed it") {
  using Catch::Contains;
  SECTION("read back") {
    Bench b({"safe_output.command_V=0.25"}, {"emergency:io@0.4"});
    const std::int64_t at = b.run(1000);
    for (int i = 0; i < 3; ++i) b.step();
    REQUIRE(b.backend.safe_output().sent_tick == at);
    REQUIRE(b.backend.safe_output().confirmed_tick == at + 1);
    REQUIRE_THAT(safe_output_text(b.backend.safe_output(), b.rig),
                 Contains("was sent at t = ") && Contains("read back"));
    for (int i = 0; i < 200; ++i) b.step();  // nor is a node stopped whose own watchdog acted
    REQUIRE(b.backend.safe_output().substitute_tick > at);
    REQUIRE(b.backend.safe_output().stop_tick == -1);
  }
  SECTION("nothing reads it back") {
    const Rig rig = can_rig();
    REQUIRE_THAT(safe_output_text({.has_outputs = true, .sent_tick = 7}, rig),
                 Contains("not confirmed: nothing reads"));
  }
  SECTION("commands are lost") {
    Bench b({"safe_output.command_V=0.25"});
    REQUIRE(b.run(700) == -1);
    b.bus->lose = [](const CanFrame& frame) { return (frame.id & 0x780) == 0x300; };
    REQUIRE(b.run(50) >= 0);
    for (int i = 0; i < 40; ++i) b.step();
    REQUIRE(b.backend.safe_output().confirmed_tick == -1);
    REQUIRE_THAT(safe_output_text(b.backend.safe_output(), b.rig), Contains("NOT confirmed"));
    for (int i = 0; i < 60; ++i) b.step();
    REQUIRE_THAT(safe_output_text(b.backend.safe_output(), b.rig),
                 Contains("told to stop (NMT)") && Contains("gives its substitute output"));
  }
}

TEST_CASE("an output that the device does not show is a fault within four cycles, lost frames and steps are none") {
  const unsigned seed = test::stated_seed().value_or(20261125u);
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 random(seed);
  Bench b;
  // Every tenth answer of the device is lost, not more than two in a row.
  int lost = 0;
  b.bus->spoil = [&](CanFrame& frame) {
    if (frame.id != 0x282 || random() % 10 != 0 || lost == 2) return lost = 0, true;
    return ++lost, false;
  };
  const std::int64_t early = b.run(500);
  INFO("faults " << b.loop.faults());
  REQUIRE((early == -1 || (b.loop.faults() & fault_output_unconfirmed) == 0));
  Bench spoofed;
  REQUIRE(spoofed.run(700) == -1);
  spoofed.bus->rewrite = [](CanFrame& frame) {  // somebody else commands 3 V in the same cycle
    if (frame.id == 0x302) put_u16(frame.data.data(), 9830);
  };
  const std::int64_t before = spoofed.tick, at = spoofed.run(10);
  REQUIRE((spoofed.loop.first_faults() & fault_output_unconfirmed) != 0);
  REQUIRE(at - before <= 4);
}

TEST_CASE("outputs of other objects take the substitute that the config names, or the start is refused") {
  using Catch::Contains;
  struct Output {
    const char *object, *value, *mode;
    int counts_per_V;
  };
  const Output o = GENERATE(Output{"0x21000110", "0x21070110", "0x21060108", 3277},
                            Output{"0x64120120", "0x64440120", "0x64430108", 3277},
                            Output{"0x62000108", "0x62070108", "0x62060108", 20});
  const std::string u = "hal.channels.u.can.";
  const std::vector<std::string> plain{u + "object=" + o.object, u + "readback={pdo: 3}",
                                       u + "scale_V_per_count=" + std::to_string(1.0 / o.counts_per_V)};
  REQUIRE_THROWS_WITH(can_rig(plain), Contains("hal.channels.u.can.substitute") && Contains(o.object));
  std::vector<std::string> named = plain;
  named.push_back(fmt::format("{}substitute={{value: {}, mode: {}}}", u, o.value, o.mode));
  named.push_back("safe_output.command_V=-0.5");
  Bench b(named);
  for (int i = 0; i < 5; ++i) {
    Measurement m;
    b.backend.read(i, m);
    b.backend.write(i, {2.0});
    b.bus->advance(b.period_ns);
  }
  REQUIRE(b.device.command_V() == Approx(2.0).margin(0.6 / o.counts_per_V));
  b.bus->advance(100'000'000);
  REQUIRE(b.device.command_V() == Approx(-0.5).margin(0.6 / o.counts_per_V));
}

TEST_CASE("a second answer each cycle is a fault within half a second, single late and repeated frames are none") {
  const unsigned seed = test::stated_seed().value_or(20261126u);
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 random(seed);
  Bench b;
  // One frame in two hundred comes twice, as CAN repeats one.
  const auto repeat = [&](unsigned one_in) {
    return [&b, &random, one_in](CanFrame& frame) {
      if ((frame.id & 0x780) == 0x180 && random() % one_in == 0) b.bus->inject(frame);
      return true;
    };
  };
  b.bus->spoil = repeat(400);
  REQUIRE(b.run(1500) == -1);
  for (const unsigned one_in : {1u, 2u, 5u}) {
    Bench doubled;
    REQUIRE(doubled.run(300) == -1);
    doubled.bus->spoil = [&, one_in](CanFrame& frame) {
      if ((frame.id & 0x780) == 0x180 && random() % one_in == 0) {
        CanFrame second = frame;
        second.data[0] ^= 0x40;  // 0.3 mm beside it
        doubled.bus->after(second);
      }
      return true;
    };
    INFO("one answer in " << one_in << " is doubled");
    const std::int64_t before = doubled.tick, at = doubled.run(500);
    REQUIRE(at >= 0);
    REQUIRE((doubled.loop.first_faults() & fault_double_answer) != 0);
    REQUIRE(at - before <= 500);
  }
}

TEST_CASE("answers never outnumber SYNC however late they come: only a second device does") {
  const unsigned seed = test::stated_seed().value_or(20261127u);
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 random(seed);
  // A device whose answers are held back for up to 40 cycles and then come at once.
  AnswerBalance late;
  std::uint32_t held = 0;
  for (int k = 0; k < 200'000; ++k) {
    ++held;
    std::uint32_t come = 0;
    if (held >= 40 || random() % 3 != 0) std::swap(come, held);
    REQUIRE_FALSE(late.end_cycle(come, 50));
  }
  // A second device, however many answers were lost before: it owes at most 50 cycles.
  AnswerBalance doubled;
  for (int k = 0; k < 1000; ++k) REQUIRE_FALSE(doubled.end_cycle(random() % 2, 50));
  int cycles = 1;
  while (!doubled.end_cycle(2, 50)) ++cycles;
  REQUIRE(cycles <= 55);
}

TEST_CASE("two devices with one number whose inputs come by their own timer show by twice as many heartbeats") {
  Bench b({"hal.can.nodes.encoder.transmission=event"});
  REQUIRE(b.run(600) == -1);
  b.bus->spoil = [&](CanFrame& frame) {
    if (frame.id == 0x703) b.bus->after(frame);
    return true;
  };
  const std::int64_t before = b.tick, at = b.run(500);
  REQUIRE(at >= 0);
  REQUIRE((b.loop.first_faults() & fault_double_answer) != 0);
  REQUIRE(at - before <= 200);
}

TEST_CASE("before any motion a second device, a second SYNC or a second master is found") {
  using Catch::Contains;
  const Rig rig = can_rig();
  PlantDevice device(rig);
  auto owned = std::make_unique<DeviceBus>(device);
  DeviceBus& bus = *owned;
  CanBackend backend(rig, std::move(owned));
  SECTION("a second device") {
    backend.configure();
    bus.spoil = [&](CanFrame& frame) {
      if (frame.id == 0x183) bus.after(frame);
      return true;
    };
    REQUIRE_THROWS_WITH(backend.activate(),
                        Contains("PDO 0x183 answers a SYNC more than once") && Contains("number 3"));
  }
  SECTION("a second master") {
    bus.inject(sync_frame());
    REQUIRE_THROWS_WITH(backend.configure(), Contains("somebody else sends SYNC"));
  }
  SECTION("one with our number") {
    bus.inject(heartbeat_frame(126, NmtState::operational));
    REQUIRE_THROWS_WITH(backend.configure(), Contains("number 126"));
  }
}

TEST_CASE("each scenario of a device gives the fault that it says, in its time") {
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(PNEUSERVO_SOURCE_DIR) + "/config/scenarios/device")) {
    const Scenario scenario = read_scenario(entry.path());
    INFO(entry.path().string());
    Bench b;
    double start_s = 1e9;
    for (const auto& [name, fault] : scenario.faults) {
      b.device.add_fault(fault);
      start_s = std::min(start_s, fault.start_s);
    }
    const std::int64_t at = b.run(static_cast<int>(std::lround((start_s + 1.0) / b.rig.period_s)));
    REQUIRE(at >= 0);
    REQUIRE((b.loop.first_faults() & fault_named(scenario.expect->fault)) != 0);
    // The device's time counts from the first probe, some ticks before tick 0.
    REQUIRE(static_cast<double>(at) * b.rig.period_s - start_s <= scenario.expect->within_s);
  }
}

TEST_CASE("a real valve follows simulated sensors on a bench alone") {
  using Catch::Contains;
  const std::string x = "hal.channels.x={simulated: true}", p = "hal.channels.p2_port={simulated: true}";
  for (const std::string& set : {x, p}) {
    REQUIRE_THROWS_WITH(can_rig({set}), Contains("simulated: true beside a real valve") && Contains("hal.bench"));
    REQUIRE_NOTHROW(can_rig({set, "hal.bench=true"}));
  }
  REQUIRE_NOTHROW(can_rig({"hal.channels.p_supply={simulated: true}"}));
  REQUIRE_NOTHROW(can_rig({x, "hal.channels.u={simulated: true}"}));
  // A law on chambers may have simulated ports, but not where a modal filter weighs them into its force.
  const std::string source = "={can: {node: io, pdo: 3, scale_Pa_per_count: 25, lowest_Pa: 50000, highest_Pa: 810000, ";
  std::vector<std::string> sets{p, "controller.pressure_source=chamber",
                                "hal.channels.p1_chamber" + source + "object: 0x64010410}}",
                                "hal.channels.p2_chamber" + source + "object: 0x64010210}}"};
  REQUIRE_NOTHROW(can_rig(sets));
  sets.emplace_back("controller.modal_filter=line");
  REQUIRE_THROWS_WITH(can_rig(sets),
                      Contains("hal.channels.p2_port") && Contains("simulated: true beside a real valve"));
}

TEST_CASE("an output on a board says what closes its valve without this program") {
  using Catch::Contains;
  const auto board = [](const std::vector<std::string>& sets) {
    return read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/comedi/cylinder-10m-7.65mm.yaml", sets);
  };
  REQUIRE_THROWS_WITH(board({"hal.comedi={}"}), Contains("hal.comedi.watchdog") && Contains("keeps its outputs"));
  REQUIRE_THROWS_WITH(board({"hal.comedi.watchdog=enable_line"}), Contains("without hal.gpio.enable"));
  REQUIRE_THROWS_WITH(board({"hal.comedi.watchdog=guard"}), Contains("without hal.guard"));
  REQUIRE_NOTHROW(board({"hal.comedi.watchdog=guard", "hal.guard={}"}));
  const auto worst = [&](const std::string& set) { return worst_level(grade_devices(board({set}))); };
  REQUIRE(worst("hal.comedi.watchdog=none") == FindingLevel::bad);
  REQUIRE(worst("hal.comedi.watchdog=external") == FindingLevel::acceptable);
  REQUIRE(worst("hal.comedi.watchdog=board") == FindingLevel::good);
  REQUIRE_THAT(device_warning(board({"hal.comedi.watchdog=none"})), Contains("NOTHING closes the valve"));
  REQUIRE(device_warning(board({"hal.comedi.watchdog=external"})).empty());
}
