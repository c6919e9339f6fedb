// Habits of real CANopen devices: each works, or is refused before motion with one sentence.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <unistd.h>

#include <catch2/catch.hpp>

#include "hal/habit_bench.hpp"

using namespace pneuservo;
using namespace pneuservo::habits;
using Catch::Contains;

TEST_CASE("an emergency before the loop runs refuses the start, unless its error is over") {
  const bool is_over = GENERATE(false, true);
  Habit h;
  bool told = false;
  h.bus->spoil = [&](CanFrame& frame) {
    if (tells(frame, encoder, NmtState::operational) && !told) {
      told = true;
      h.bus->after(emergency_frame({encoder, 0x5000, 0x81}));
      if (is_over) h.bus->after(emergency_frame({encoder, 0x0000, 0x00}));
    }
    return true;
  };
  if (is_over) REQUIRE_NOTHROW(h.start());
  else
    REQUIRE_THROWS_WITH(h.start(),
                        Contains("node encoder (3) reported emergency 0x5000 (device hardware), error register 0x81 "
                                 "(generic, manufacturer)"));
}

TEST_CASE("an error register that is set refuses the start") {
  Habit h;
  h.bus->spoil = [](CanFrame& frame) {
    const auto answer = parse_sdo_answer(frame);
    if (answer && frame.id == cob_sdo_answer + encoder && answer->index == 0x1001) frame.data[4] = 0x11;
    return true;
  };
  REQUIRE_THROWS_WITH(h.start(), Contains("node encoder (3)") && Contains("0x1001 is 0x11 (generic, communication)"));
}

TEST_CASE("emergencies, SYNC and its counter are put where they are listened to") {
  Habit h;
  h.dictionary(encoder).add_number(0x1014, 0, 32, 0x80000085, true);
  h.dictionary(encoder).add_number(0x1005, 0, 32, 0x81, true);
  h.dictionary(encoder).add_number(0x1019, 0, 8, 10, true);
  h.start();
  CHECK(h.dictionary(encoder).number(0x1014, 0) == 0x83);
  CHECK(h.dictionary(encoder).number(0x1005, 0) == 0x80);
  CHECK(h.dictionary(encoder).number(0x1019, 0) == 0);
}

TEST_CASE("an emergency object that cannot be moved is told") {
  Habit h;
  h.dictionary(encoder).add_number(0x1014, 0, 32, 0x80000083, false);
  h.start();
  CHECK_THAT(h.notes(), Contains("node encoder (3): its 0x1014 is 0x80000083") && Contains("not seen"));
}

TEST_CASE("a PDO longer than its mapping is taken by its first bytes, a shorter one is named with its length") {
  const int more = GENERATE(4, -1);
  Habit h;
  h.bus->spoil = [&](CanFrame& frame) {
    if (frame.id == 0x183) frame.length = static_cast<std::uint8_t>(frame.length + more);
    return true;
  };
  if (more > 0) REQUIRE_NOTHROW(h.start());
  else
    REQUIRE_THROWS_WITH(h.start(),
                        Contains("node encoder (3): PDO 0x183 has 3 bytes, its mapping 4") && !Contains("0x282"));
}

TEST_CASE("who does not become operational is named with its state and emergency") {
  Habit h;
  h.bus->lose = [&](const CanFrame& frame) {
    const bool is_start = frame.id == 0 && frame.data[0] == 1 && frame.data[1] == encoder;
    if (is_start) h.bus->inject(emergency_frame({encoder, 0xFF00, 0x81}));
    return is_start;
  };
  REQUIRE_THROWS_WITH(h.start(),
                      Contains("node encoder (3) did not become operational within 2 s, it stays pre-operational; "
                               "it reported emergency 0xff00"));
}

TEST_CASE("a sensor without heartbeat consumer or producer is used and told, a node with the valve is refused") {
  const auto missing = GENERATE(0x1016, 0x1017);
  constexpr auto no_object = static_cast<std::uint32_t>(SdoAbort::no_object);
  Habit sensor;
  sensor.refuse(encoder, static_cast<std::uint16_t>(missing), no_object);
  REQUIRE_NOTHROW(sensor.start());
  CHECK_THAT(sensor.notes(), Contains("node encoder (3): it has no 0x101"));
  Habit valve;
  valve.refuse(io, static_cast<std::uint16_t>(missing), no_object);
  REQUIRE_THROWS_WITH(valve.start(), Contains("node io (2): it has no 0x101"));
}

TEST_CASE("what holds the wanted value already is not written") {
  Habit h;
  h.dictionary(encoder).set_number(0x1800, 2, 1);
  for (const std::uint8_t sub : {1, 2, 3, 5}) h.dictionary(encoder).find(0x1800, sub)->can_write = false;
  REQUIRE_NOTHROW(h.start());
}

TEST_CASE("an identifier that can only be read does not hold up the PDO's other objects") {
  Habit h;
  h.dictionary(encoder).find(0x1800, 1)->can_write = false;
  h.dictionary(encoder).set_number(0x1800, 3, 100);
  REQUIRE_NOTHROW(h.start());
  CHECK(h.dictionary(encoder).number(0x1800, 3) == 0);
}

TEST_CASE("an identifier changes only while its PDO is off") {
  Habit h;
  h.dictionary(io).set_number(0x1801, 1, 0x400001A2);
  std::uint32_t held = 0x400001A2;
  int changes = 0;
  h.bus->lose = [&](const CanFrame& frame) {
    const auto request = parse_sdo(frame);
    if (frame.id != cob_sdo_request + io || !request || request->specifier != sdo_download ||
        request->index != 0x1801 || request->sub != 1)
      return false;
    const std::uint32_t wanted = get_u32(&frame.data[4]);
    if (((held ^ wanted) & 0x3FFFFFFFu) != 0) {
      ++changes;
      CHECK((held & wanted & 0x80000000u) != 0);
    }
    held = wanted;
    return false;
  };
  h.start();
  CHECK(changes == 1);
  CHECK((held & 0xBFFFFFFFu) == 0x282);
}

TEST_CASE("a node that starts itself is configured in pre-operational") {
  Habit h;
  bool pre_operational = false, asked = false;
  h.bus->lose = [&](const CanFrame& frame) {
    if (frame.id == 0 && frame.data[0] == 0x80 && frame.data[1] == encoder) pre_operational = true;
    if (frame.id == cob_sdo_request + encoder && !asked) {
      asked = true;
      CHECK(pre_operational);
    }
    return false;
  };
  h.start();
  CHECK(asked);
}

TEST_CASE("SDO is asked again: slow after boot-up, one answer lost, answers of their own length") {
  const std::string how = GENERATE("slow", "lost", "short");
  Habit h;
  std::int64_t since = -1;
  bool lost = false;
  if (how == "slow")
    h.bus->lose = [&](const CanFrame& frame) {
      if (frame.id != cob_sdo_request + encoder) return false;
      if (since < 0) since = h.bus->now;
      return h.bus->now - since < 1'800'000'000;
    };
  else
    h.bus->spoil = [&](CanFrame& frame) {
      const auto answer = parse_sdo_answer(frame);
      if (!answer || frame.id != cob_sdo_answer + encoder) return true;
      if (how == "lost" && answer->index == 0x1017 && !lost) return !(lost = true);
      if (how == "short" && answer->specifier == sdo_upload_begun && answer->expedited)
        frame.length = static_cast<std::uint8_t>(8 - answer->unused);
      if (how == "short" && answer->specifier == sdo_downloaded) frame.length = 4;
      return true;
    };
  INFO(how);
  REQUIRE_NOTHROW(h.start());
}

TEST_CASE("abort codes have words, and the device's own their number") {
  CHECK_THAT(sdo_abort_text(0x06060000), Contains("hardware error"));
  CHECK_THAT(sdo_abort_text(0x06040043), Contains("parameters do not fit"));
  CHECK_THAT(sdo_abort_text(0x08000021), Contains("local control"));
  CHECK_THAT(sdo_abort_text(0x12345678), Contains("0x12345678"));
}

TEST_CASE("the fifth PDO and further ones that no channel uses are off") {
  Habit h;
  for (const std::uint16_t index : {0x1804, 0x180B}) {
    h.dictionary(encoder).add_number(index, 0, 8, 2, false);
    h.dictionary(encoder).add_number(index, 1, 32, 0x1C3, true);
  }
  h.start();
  CHECK(h.dictionary(encoder).number(0x1804, 1) == 0x800001C3);
  CHECK(h.dictionary(encoder).number(0x180B, 1) == 0x800001C3);
}

TEST_CASE("event-driven PDOs alone: the key that takes them is named") {
  Habit h;
  h.dictionary(encoder).set_number(0x1800, 2, 255);
  h.refuse(encoder, 0x1800, static_cast<std::uint32_t>(SdoAbort::value), true);
  REQUIRE_THROWS_WITH(h.start(), Contains("hal.can.nodes.encoder.transmission: event"));
}

TEST_CASE("another device than the one that was expected is refused") {
  Habit vendor({"hal.can.nodes.encoder.vendor=31"});
  vendor.dictionary(encoder).set_number(0x1018, 1, 0x22);
  REQUIRE_THROWS_WITH(vendor.start(), Contains("node encoder (3): 0x1018:1 states vendor 0x22, expected 0x1f"));
}

TEST_CASE("a valve's module without substitute output is refused with the reason") {
  Habit h;
  h.refuse(io, 0x6444, static_cast<std::uint32_t>(SdoAbort::no_object));
  REQUIRE_THROWS_WITH(h.start(),
                      Contains("node io (2): it has no object 0x6444:1") && Contains("keep its last command"));
}

TEST_CASE("a module without heartbeats is guarded: asked for its state, lost when it is silent") {
  const auto missing = static_cast<std::uint16_t>(GENERATE(0x1016, 0x1017));
  Habit h;
  h.refuse(io, missing, static_cast<std::uint32_t>(SdoAbort::no_object));
  h.dictionary(io).add_number(0x100C, 0, 16, 0, true);
  h.dictionary(io).add_number(0x100D, 0, 8, 0, true);
  h.start();
  CHECK_THAT(h.notes(), Contains("node io (2): it lacks a heartbeat: asked for its state every 0.02 s"));
  CHECK(h.dictionary(io).number(0x100C, 0) == 20);
  CHECK(h.dictionary(io).number(0x100D, 0) == 3);  // 60 ms of watchdog_s
  AxisLoop loop;
  loop.configure(h.rig);
  std::int64_t tick = 0;
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks && loop.faults() == 0; ++i) {
      loop.pass(h.backend, tick++, 0, nullptr, nullptr);
      h.bus->advance(1'000'000);
    }
  };
  SECTION("it answers, each time with another toggle bit, and one lost answer is no loss") {
    bool lost = false;
    h.also_spoil([&](CanFrame& frame) {
      const bool loses = frame.id == cob_heartbeat + io && tick > 200 && !lost;
      lost = lost || loses;
      return !loses;
    });
    run(500);
    CHECK(lost);
    CHECK(loop.faults() == 0);
  }
  SECTION("answers whose toggle bit stands still are none") {
    h.also_spoil([](CanFrame& frame) {
      if (frame.id == cob_heartbeat + io) frame.data[0] &= 0x7F;
      return true;
    });
    run(100);
    CHECK((loop.faults() & fault_node_lost) != 0);
  }
  SECTION("it falls silent") {
    h.also_spoil([](CanFrame& frame) { return frame.id != cob_heartbeat + io; });
    run(100);
    CHECK((loop.faults() & fault_node_lost) != 0);
  }
}

TEST_CASE("a guarded module gives its substitute output when it is no longer asked") {
  Habit h({"safe_output.command_V=0.1"});
  h.refuse(io, 0x1016, static_cast<std::uint32_t>(SdoAbort::no_object));
  h.dictionary(io).add_number(0x100C, 0, 16, 0, true);
  h.dictionary(io).add_number(0x100D, 0, 8, 0, true);
  h.start();
  h.backend.write(0, {.valve_V = 1.0, .valve_2_V = 0.0, .enable = true, .ended = false});
  CHECK(std::abs(h.device.command_V() - 1.0) < 1e-3);
  h.bus->advance(100'000'000);
  CHECK(std::abs(h.device.command_V() - 0.1) < 1e-3);
}

TEST_CASE("a multi-turn encoder that wraps between the limits shows one course of the position") {
  // 100000 counts of 5 um: the slider goes through the end of the counts at 0.
  Habit h({"hal.channels.x.can.wrap_counts=100000", "initial.position_m=-0.02", "reference.amplitude_m=0.05"});
  h.start();
  AxisLoop loop;
  loop.configure(h.rig);
  double lowest = 1.0, highest = -1.0;
  for (int tick = 0; tick < 2500; ++tick) {
    loop.pass(h.backend, tick, 0, nullptr, nullptr);
    h.bus->advance(1'000'000);
    if (tick == 0) continue;
    const double x = loop.row().measured[Signal::x];
    REQUIRE(std::abs(x - h.device.truth().x_m) < 2e-3);  // a period older
    lowest = std::min(lowest, x);
    highest = std::max(highest, x);
  }
  CHECK(loop.faults() == 0);
  CHECK(lowest < -0.02);
  CHECK(highest > 0.02);
}

TEST_CASE("the worked example of docs/can.md starts, and the valve of 0 to 10 V has its neutral 5 V as safe output") {
  namespace fs = std::filesystem;
  const fs::path source = PNEUSERVO_SOURCE_DIR,
                 folder = fs::temp_directory_path() / ("pneuservo-can-example-" + std::to_string(getpid()));
  const auto text_of = [](const fs::path& path) {
    std::ifstream file(path);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string page = text_of(source / "docs/can.md"),
                    config = text_of(source / "config/can/cylinder-10m-7.65mm.yaml");
  const std::size_t begin = page.find("```yaml\n", page.find("### From the EDS to the config")) + 8;
  fs::create_directories(folder);
  fs::copy_file(source / "config/can/analog-module-401.eds", folder / "analog-module-401.eds",
                fs::copy_options::overwrite_existing);
  std::ofstream(folder / "rig.yaml") << config.substr(0, config.find("\nhal:\n") + 1)
                                     << page.substr(begin, page.find("```", begin) - begin);
  const Rig rig = read_rig((folder / "rig.yaml").string());
  PlantDevice device(rig);
  CanBackend backend(rig, std::make_unique<DeviceBus>(device));
  backend.configure();
  backend.activate();
  for (const auto& node : device.nodes()) {
    if (node->node() != io) continue;
    const double terminal_V_per_count = 10.0 / 32768.0;
    CHECK(node->dictionary().number(0x6411, 1) * terminal_V_per_count == 5.0);
    CHECK(node->dictionary().number(0x6444, 1) * terminal_V_per_count == 5.0);
  }
  CHECK(device.command_V() == 0.0);
  fs::remove_all(folder);
}
