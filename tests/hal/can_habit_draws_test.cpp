// Combinations of habits of real CANopen devices, drawn: each works, or is refused before motion with one sentence.
#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/test_seed.hpp"
#include "hal/habit_bench.hpp"

using namespace pneuservo;
using namespace pneuservo::habits;

namespace {

using Words = std::vector<std::string>;
constexpr std::uint32_t no_object = 0x06020000, out_of_range = 0x06090030;

/// One habit; of one `group` a device has one at most. Without `refused` it works, else the sentence has these words.
struct Known {
  std::string name, group;
  std::function<void(Habit&)> apply;
  Words sets{}, refused{};
};

/// Anything the node answers to a request.
bool answers(const CanFrame& frame, std::uint8_t node) { return frame.id == cob_sdo_answer + node; }
bool is_pdo_object(std::uint16_t index) { return index >= 0x1400 && index < 0x1C00; }

void lose_first_answer(Habit& h, std::uint8_t node) {
  h.also_spoil([node, lost = false](CanFrame& frame) mutable {
    if (lost || !answers(frame, node)) return true;
    lost = true;
    return false;
  });
}

void answer_briefly(Habit& h) {
  h.also_spoil([](CanFrame& frame) {
    const auto answer = parse_sdo_answer(frame);
    if (!answer || (!answers(frame, io) && !answers(frame, encoder))) return true;
    if (answer->specifier == sdo_upload_begun && answer->expedited)
      frame.length = static_cast<std::uint8_t>(8 - answer->unused);
    if (answer->specifier == sdo_downloaded) frame.length = 4;
    return true;
  });
}

void be_silent_after_boot(Habit& h) {
  h.also_lose([bus = h.bus, since = std::int64_t{-1}](const CanFrame& frame) mutable {
    if (frame.id != cob_sdo_request + encoder) return false;
    if (since < 0) since = bus->now;
    return bus->now - since < 800'000'000;
  });
}

void start_itself(Habit& h) {
  h.also_spoil([&h](CanFrame& frame) {
    std::vector<CanFrame> none;
    if (tells(frame, encoder, NmtState::boot_up))
      h.node(encoder).on_frame(nmt_frame(NmtCommand::start, encoder), h.bus->now, none);
    return true;
  });
  h.also_judge(encoder, [&h](std::uint16_t index, std::uint8_t, std::uint32_t) {
    return is_pdo_object(index) && h.node(encoder).state() != NmtState::pre_operational ? SdoAbort::state
                                                                                        : SdoAbort::none;
  });
}

void hold_identifiers(Habit& h) {
  h.dictionary(io).set_number(0x1801, 1, 0x400001A2);
  for (const std::uint8_t node : {io, encoder})
    h.also_judge(node, [&h, node](std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
      const bool is_pdo = is_pdo_object(index) && (index & 0x200) == 0;
      const std::uint32_t held = h.dictionary(node).number(index, sub);
      const bool changes = is_pdo && sub == 1 && (held & pdo_off) == 0 && ((held ^ value) & 0x3FFFFFFF) != 0;
      return changes ? SdoAbort::value : SdoAbort::none;
    });
}

void be_guarded(Habit& h, std::uint8_t node, std::uint16_t lacks) {
  h.refuse(node, lacks, no_object);
  h.dictionary(node).add_number(0x100C, 0, 16, 0, true);
  h.dictionary(node).add_number(0x100D, 0, 8, 0, true);
}

void add_fifth_pdo(Habit& h) {
  h.dictionary(encoder).add_number(0x1804, 0, 8, 2, false);
  h.dictionary(encoder).add_number(0x1804, 1, 32, 0x1C3, true);
}

void move_objects(Habit& h) {
  for (const std::uint8_t node : {io, encoder}) {
    h.dictionary(node).add_number(0x1014, 0, 32, pdo_off | 0x85, true);
    h.dictionary(node).add_number(0x1005, 0, 32, 0x81, true);
    h.dictionary(node).add_number(0x1019, 0, 8, 10, true);
  }
}

void lengthen(Habit& h, std::uint32_t id, int more) {
  h.also_spoil([=](CanFrame& frame) {
    if (frame.id == id && frame.length > 0)
      frame.length = static_cast<std::uint8_t>(std::clamp(frame.length + more, 1, 8));
    return true;
  });
}

void tell_emergency(Habit& h, NmtState when, bool is_over) {
  h.also_spoil([&h, when, is_over, told = false](CanFrame& frame) mutable {
    if (told || !tells(frame, encoder, when)) return true;
    told = true;
    h.bus->after(emergency_frame({encoder, 0x5000, 0x81}));
    if (is_over) h.bus->after(emergency_frame({encoder, 0x0000, 0x00}));
    return true;
  });
}

void take_event_types_alone(Habit& h, std::uint32_t lowest) {
  h.dictionary(encoder).set_number(0x1800, 2, 255);
  h.also_judge(encoder, [lowest](std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
    return index == 0x1800 && sub == 2 && value < lowest ? SdoAbort::value : SdoAbort::none;
  });
}

/// Frames with 29 bits and remote ones under the process data's identifier.
void be_noisy(Habit& h) {
  h.also_spoil([&h](CanFrame& frame) {
    if (frame.id != 0x282) return true;
    h.bus->after({.id = 0x183, .length = 4, .data = {0xFF, 0xFF, 0xFF, 0xFF}, .extended = true});
    h.bus->after({.id = 0x183, .length = 4, .remote = true});
    return true;
  });
}

/// Habits that the program copes with.
std::vector<Known> working() {
  const Words by_event{"hal.can.nodes.encoder.transmission=event"};
  const auto wraps = [](const char* counts) { return Words{std::string("hal.channels.x.can.wrap_counts=") + counts}; };
  return {
      {"objects moved (0x1014, 0x1005, 0x1019)", "moved", move_objects},
      {"PDO longer than mapped", "length", [](Habit& h) { lengthen(h, 0x183, 4); }},
      {"PDO of the module longer than mapped", "length of io", [](Habit& h) { lengthen(h, 0x282, 8); }},
      {"sensor without 0x1016", "life of encoder", [](Habit& h) { h.refuse(encoder, 0x1016, no_object); }},
      {"sensor guarded", "life of encoder", [](Habit& h) { be_guarded(h, encoder, 0x1017); }},
      {"module guarded, no producer", "life of io", [](Habit& h) { be_guarded(h, io, 0x1017); }},
      {"module guarded, no consumer", "life of io", [](Habit& h) { be_guarded(h, io, 0x1016); }},
      {"identifier read-only", "read-only", [](Habit& h) { h.dictionary(encoder).find(0x1800, 1)->can_write = false; }},
      {"identifier held while valid", "identifiers", hold_identifiers},
      {"starts itself", "starts", start_itself},
      {"slow after boot-up", "slow", be_silent_after_boot},
      {"first answer lost", "lost", [](Habit& h) { lose_first_answer(h, encoder); }},
      {"first answer of the module lost", "lost of io", [](Habit& h) { lose_first_answer(h, io); }},
      {"brief SDO answers", "brief", answer_briefly},
      {"fifth PDO", "fifth", add_fifth_pdo},
      {"makers' inhibit time and timer", "times",
       [](Habit& h) {
         h.dictionary(encoder).set_number(0x1800, 3, 100);
         h.dictionary(io).set_number(0x1801, 3, 100);
         h.dictionary(io).set_number(0x1801, 5, 50);
       }},
      {"leaves no state without master", "1029", [](Habit& h) { h.dictionary(io).set_number(0x1029, 1, 1); }},
      {"no 0x1029", "1029", [](Habit& h) { h.refuse(io, 0x1029, no_object); }},
      {"emergency that is over", "emergency", [](Habit& h) { tell_emergency(h, NmtState::boot_up, true); }},
      {"event types alone", "type", [](Habit& h) { take_event_types_alone(h, 254); }, by_event},
      {"type 255 alone", "type", [](Habit& h) { take_event_types_alone(h, 255); }, by_event},
      {"multi-turn, 25 bits", "counts", [](Habit&) {}, wraps("33554432")},
      {"multi-turn, no power of two", "counts", [](Habit&) {}, wraps("100000")},
      {"19 counting bits", "counts", [](Habit&) {}, {"hal.channels.x.can.object=0x60200113"}},
      {"noise of other kinds of frame", "noise", be_noisy},
      {"SYNC of another master", "sync", [](Habit&) {}, {"hal.can.sync=foreign"}},
  };
}

std::vector<Known> refused() {
  const auto set = [](std::uint8_t node, std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
    return [=](Habit& h) { h.dictionary(node).add_number(index, sub, index == 0x1001 ? 8 : 32, value, false); };
  };
  return {
      {"emergency at boot-up",
       "emergency",
       [](Habit& h) { tell_emergency(h, NmtState::boot_up, false); },
       {},
       {"node encoder (3)", "emergency 0x5000 (device hardware)", "mend the cause"}},
      {"emergency at the start",
       "emergency",
       [](Habit& h) { tell_emergency(h, NmtState::operational, false); },
       {},
       {"node encoder (3)", "emergency 0x5000 (device hardware)", "mend the cause"}},
      {"error register",
       "error register",
       [](Habit& h) {
         h.also_spoil([](CanFrame& frame) {
           const auto answer = parse_sdo_answer(frame);
           if (answer && answers(frame, encoder) && answer->index == 0x1001) frame.data[4] = 0x11;
           return true;
         });
       },
       {},
       {"node encoder (3)", "0x1001 is 0x11", "mend the cause"}},
      {"PDO shorter than mapped",
       "length",
       [](Habit& h) { lengthen(h, 0x183, -1); },
       {},
       {"node encoder (3)", "0x183", "bytes, its mapping", "hal.channels"}},
      {"refuses operational",
       "starts",
       [](Habit& h) {
         h.also_lose(
             [](const CanFrame& frame) { return frame.id == 0 && frame.data[0] == 1 && frame.data[1] == encoder; });
       },
       {},
       {"node encoder (3)", "did not become operational", "it stays pre-operational", "see its manual"}},
      {"valve without 0x1016",
       "life of io",
       [](Habit& h) { h.refuse(io, 0x1016, no_object); },
       {},
       {"node io (2)", "0x1016", "a node that can is needed"}},
      {"valve without 0x1017",
       "life of io",
       [](Habit& h) { h.refuse(io, 0x1017, no_object); },
       {},
       {"node io (2)", "0x1017", "possible only for"}},
      {"event types alone, not told",
       "type",
       [](Habit& h) { take_event_types_alone(h, 254); },
       {},
       {"node encoder (3)", "0x1800:2", "hal.can.nodes.encoder.transmission: event"}},
      {"another vendor",
       "vendor",
       set(encoder, 0x1018, 1, 0x22),
       {"hal.can.nodes.encoder.vendor=31"},
       {"node encoder (3)", "0x1018:1", "0x22", "0x1f", "is another device there?"}},
      {"another profile",
       "profile",
       set(encoder, 0x1000, 0, 0x0192),
       {},
       {"node encoder (3)", "0x1000", "402", "406", "hal.can.nodes.encoder.profile"}},
      {"no substitute output",
       "substitute",
       [](Habit& h) { h.refuse(io, 0x6444, no_object); },
       {},
       {"node io (2)", "0x6444:1", "hal.channels.u.can.substitute"}},
      {"refuses its heartbeat's time",
       "life of encoder",
       [](Habit& h) {
         h.also_judge(encoder, [](std::uint16_t index, std::uint8_t, std::uint32_t) {
           return index == 0x1017 ? static_cast<SdoAbort>(out_of_range) : SdoAbort::none;
         });
       },
       {},
       {"node encoder (3)", "0x1017:0", "value out of range", "found 0x0, expected 0x14", "manual"}},
      {"never answers requests",
       "slow",
       [](Habit& h) { h.also_lose([](const CanFrame& frame) { return frame.id == cob_sdo_request + encoder; }); },
       {},
       {"node encoder (3)", "no answer", "hal.can.nodes.encoder.sdo_timeout_s"}},
      {"never comes up",
       "boot",
       [](Habit& h) { h.also_spoil([](CanFrame& frame) { return !tells(frame, encoder, NmtState::boot_up); }); },
       {},
       {"node encoder (3)", "did not come up within 2 s", "is it there"}},
      {"counts wrap within the travel",
       "counts",
       set(encoder, 0x6002, 0, 50000),
       {},
       {"node encoder (3)", "0x6002", "50000", "64000", "hal.channels.x.can"}},
      {"another measuring range than stated",
       "counts",
       [](Habit& h) { h.dictionary(encoder).add_number(0x6002, 0, 32, 200000, false); },
       {"hal.channels.x.can.wrap_counts=100000"},
       {"node encoder (3)", "0x6002", "200000", "100000", "wrong"}},
      {"SYNC of another master, not told",
       "sync",
       [](Habit& h) { h.device.sends_sync = true; },
       {},
       {"somebody else sends SYNC", "end the other master", "hal.can.sync: foreign"}},
      {"no SYNC of another master",
       "sync",
       [](Habit& h) { h.device.sends_sync = false; },
       {"hal.can.sync=foreign"},
       {"hal.can.sync is foreign", "found 0 SYNC", "expected one every 0.001 s", "start the master"}},
  };
}

/// What has been started goes on: every input is there in each tick, and the position is that of the device's plant.
void require_that_it_runs(Habit& h) {
  const auto period_ns = static_cast<std::int64_t>(h.rig.period_s * 1e9);
  for (int tick = 0; tick < 150; ++tick) {
    if (h.backend.is_paced()) h.backend.await_sample();
    Measurement measured;
    REQUIRE(h.backend.read(tick, measured));
    INFO(fmt::format("tick {}: {}", tick, fmt::join(h.backend.notes(), "\n")));
    REQUIRE(measured.device_faults == 0);
    for (const Signal signal : {Signal::x, Signal::p1_port, Signal::p2_port, Signal::p_supply})
      REQUIRE((tick == 0 || measured.channel[signal].valid));
    const double x = measured.channel[Signal::x].value;
    REQUIRE((tick == 0 || std::abs(x - h.device.truth().x_m) < 1e-3));
    REQUIRE(h.backend.write(tick, {.valve_V = 1.0, .enable = true}));
    if (!h.backend.is_paced()) h.bus->advance(period_ns);
  }
  REQUIRE(std::abs(h.device.command_V() - 1.0) < 1e-3);
}

std::string refusal_of(Habit& h) {
  try {
    h.start();
  } catch (const std::exception& error) { return error.what(); }
  return "";
}

/// One device with all of these habits.
void try_out(const std::vector<const Known*>& habits) {
  Words names, sets;
  for (const Known* habit : habits) {
    names.push_back(habit->name);
    sets.insert(sets.end(), habit->sets.begin(), habit->sets.end());
  }
  INFO(fmt::format("habits: {}", fmt::join(names, "; ")));
  Habit h(sets);
  for (const Known* habit : habits) habit->apply(h);
  const std::string said = refusal_of(h);
  INFO(said);
  const auto is_named = [&](const Known* habit) {
    return !habit->refused.empty() && std::ranges::all_of(habit->refused, [&](const std::string& word) {
      return said.find(word) != std::string::npos;
    });
  };
  const bool works = std::ranges::all_of(habits, [](const Known* habit) { return habit->refused.empty(); });
  if (works) {
    REQUIRE(said.empty());
    return require_that_it_runs(h);
  }
  CHECK(std::ranges::any_of(habits, is_named));
  CHECK(said.find('\n') == std::string::npos);
  CHECK(h.device.command_V() == 0.0);
}

}  // namespace

TEST_CASE("each habit of a device alone works, or is refused with its sentence") {
  for (const std::vector<Known>& all : {working(), refused()})
    for (const Known& habit : all) try_out({&habit});
}

// Half of the draws are of habits that work: each of them has to bear the others.
TEST_CASE("habits of devices, drawn as combinations, work or are refused with a sentence of theirs") {
  const unsigned seed = test::new_seed();
  INFO("PNEUSERVO_TEST_SEED=" << seed);
  std::mt19937 draws(seed);
  const std::vector<Known> good = working(), bad = refused();
  for (int combination = 0; combination < 40; ++combination) {
    std::vector<const Known*> pool, chosen;
    for (const Known& habit : good) pool.push_back(&habit);
    std::ranges::shuffle(pool, draws);
    if (combination % 2 == 1) pool.insert(pool.begin(), &bad[draws() % bad.size()]);
    const std::size_t most = 2 + draws() % 5;
    for (const Known* habit : pool) {
      const bool is_free =
          std::ranges::none_of(chosen, [&](const Known* other) { return other->group == habit->group; });
      if (chosen.size() < most && is_free) chosen.push_back(habit);
    }
    try_out(chosen);
  }
}
