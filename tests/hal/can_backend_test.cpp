// Controller and simulated device on one bus, with real frames: values, age, faults, and the way into the safe output.
#include <catch2/catch.hpp>

#include <cmath>
#include <memory>

#include <pneuservo/loop/axis_loop.hpp>

#include "can/can_backend.hpp"
#include "composite/composite_backend.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "hal/can_bench.hpp"
#include "rig/bus_load.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

double rms_error(const std::vector<double>& errors) {
  double sum = 0.0;
  for (const double e : errors) sum += e * e;
  return std::sqrt(sum / static_cast<double>(errors.size()));
}

}  // namespace

TEST_CASE("the setup writes watchdog, heartbeat, substitute output and mapping into the device") {
  Bench b({"safe_output.command_V=-0.5"});
  ObjectDictionary& io = b.device.nodes()[1]->dictionary();  // by name: encoder, io
  REQUIRE(b.device.nodes()[1]->name() == "io");
  REQUIRE(io.number(0x1016, 1) == (126u << 16 | 60));
  REQUIRE(io.number(0x1017, 0) == 20);
  REQUIRE(io.number(0x6443, 1) == 1);
  REQUIRE(static_cast<std::int32_t>(io.number(0x6444, 1)) == -1638);  // -0.5 V of 10/32768 V
  REQUIRE(io.number(0x1A01, 0) == 4);
  REQUIRE(io.number(0x1A01, 3) == 0x64010310);
  REQUIRE(io.number(0x1A01, 4) == 0x64110110);  // the output, read back
  REQUIRE(b.device.nodes()[0]->dictionary().number(0x1016, 1) == 126u << 16);  // a sensor does not watch us
  REQUIRE(io.number(0x1801, 1) == 0x282);
  REQUIRE(io.number(0x1801, 2) == 1);
  REQUIRE(io.number(0x1601, 1) == 0x64110110);
  for (auto& node : b.device.nodes()) REQUIRE(node->state() == NmtState::operational);
}

TEST_CASE("each tick finds what was sampled a period before, to the bit of the counts, and sends one PDO and SYNC") {
  Bench b;
  // The same plant and the same noise, asked at the same times: the probes of the start count as ticks of the device.
  for (int i = 0; i < 400; ++i) {
    Measurement m;
    REQUIRE(b.backend.read(i, m));
    const auto& dictionary = b.device.nodes()[0]->dictionary();
    const auto counts = static_cast<std::int32_t>(dictionary.number(0x6020, 1));
    if (i == 0) {  // no SYNC of the loop yet: no sample of a known age
      REQUIRE_FALSE(m.channel[Signal::x].valid);
    } else {
      REQUIRE((m.channel[Signal::x].valid && m.channel[Signal::x].value == 5e-6 * counts));
      REQUIRE(m.channel[Signal::x].origin == Origin::real);
      REQUIRE(m.channel[Signal::x].age_s == Approx(b.rig.period_s).epsilon(1e-9));
    }
    const auto pressure = static_cast<std::int16_t>(b.device.nodes()[1]->dictionary().number(0x6401, 2));
    if (i > 0) REQUIRE((m.channel[Signal::p2_port].valid && m.channel[Signal::p2_port].value == 25.0 * pressure));
    REQUIRE(m.channel[Signal::p1_chamber].origin == Origin::absent);
    const double command = 2.0 * std::sin(0.05 * i);
    const std::size_t before = b.bus->sent.size();
    REQUIRE(b.backend.write(i, {command}));
    REQUIRE(b.bus->sent.at(before).id == 0x302);
    REQUIRE(is_sync(b.bus->sent.at(before + 1)));
    REQUIRE(b.device.command_V() == Approx(command).margin(0.5 * 10.0 / 32768.0));
    b.bus->advance(b.period_ns);
  }
  const CanCounts& counts = b.backend.process().counts();
  REQUIRE(counts.missed == 0);
  REQUIRE(counts.late == 0);
  REQUIRE(counts.malformed == 0);
  REQUIRE(counts.slowest_answer_ns == 200'000);
}

TEST_CASE("the position error over the bus is that of the simulated backend with inputs of the same age, within 1 %") {
  const std::vector<std::string> sets{"duration_s=3"};
  Bench b(sets);
  REQUIRE(b.run(3000) == -1);
  std::vector<double> over_bus, in_process;
  Bench again(sets);
  for (int i = 0; i < 3000; ++i) {
    again.step();
    if (i > 1000) over_bus.push_back(again.loop.row().x_ref_m - again.device.truth().x_m);
  }
  Rig rig = can_rig({"duration_s=3", "simulation.input_age_periods=1"});
  SimBackend sim(rig);
  AxisLoop loop;
  loop.configure(rig);
  sim.configure();
  sim.activate();
  for (int i = 0; i < 3000; ++i) {
    loop.pass(sim, i, 0, nullptr, nullptr);
    if (i > 1000) in_process.push_back(loop.row().x_ref_m - sim.truth().x_m);
  }
  REQUIRE(loop.faults() == 0);
  REQUIRE(rms_error(over_bus) == Approx(rms_error(in_process)).epsilon(0.01));
}

TEST_CASE("faults on the bus are found, named, and the safe output is on the wire in the same tick") {
  struct Case {
    const char* order;
    std::uint64_t fault;
    int within_ticks;
  };
  // A node's silence is known after 2.5 heartbeats of 20 ms, wrong samples after the guard's three.
  const Case c = GENERATE(
      Case{"emergency:io:0x3100@0.2", fault_node_emergency, 2}, Case{"reboot:encoder@0.2", fault_node_lost, 2},
      Case{"no_heartbeat:io@0.2", fault_node_lost, 52}, Case{"off:encoder@0.2", fault_position_missing, 4},
      Case{"drop:encoder@0.2", fault_position_missing, 4}, Case{"drop:io@0.2", fault_port_pressure_1_missing, 4},
      Case{"saturate:p2_port@0.2", fault_port_pressure_2_missing, 4},
      Case{"bias:p1_port:5e6@0.2", fault_port_pressure_1_missing, 4},
      Case{"freeze:p1_port@0.2", fault_port_pressure_1_frozen, 22}, Case{"bus_off@0.2", fault_bus_off, 2});
  INFO(c.order);
  Bench b({"safe_output.command_V=0.25"}, {c.order});
  const std::int64_t at = b.run(1000);
  REQUIRE((b.loop.first_faults() & c.fault) != 0);
  // The device's time counts from the first probe, some ticks before tick 0.
  REQUIRE(at >= 194);
  REQUIRE(at <= 200 + c.within_ticks);
  REQUIRE(b.loop.row().u_V == 0.25);
  if (c.fault != fault_bus_off) REQUIRE(b.device.command_V() == Approx(0.25).margin(2e-4));
  if (c.fault == fault_node_emergency)
    REQUIRE(b.backend.notes().front().find("node io (2): emergency 0x3100 (voltage)") != std::string::npos);
}

TEST_CASE("a spike is bridged, and a period in which an answer is a cycle late is no sample") {
  Bench spike({}, {"spike:x:0.02@0.2"});
  REQUIRE(spike.run(600) == -1);
  Bench late({}, {"late:io@0.2+0.0005"});
  REQUIRE(late.run(600) == -1);
  REQUIRE(late.backend.process().counts().late == 1);
  REQUIRE(late.backend.process().counts().missed == 1);
}

TEST_CASE("after the end the bus is read off the loop's grid, and no answer is late") {
  Bench b;
  REQUIRE(b.run(100) == -1);
  for (int i = 0; i < 3; ++i) {  // a second SYNC before the answers to the last one are read
    b.loop.stop(b.backend, b.tick + i);
    b.bus->advance(b.period_ns);
  }
  Measurement answers;
  b.backend.read(b.tick + 3, answers);
  REQUIRE(b.backend.process().counts().late == 0);
  REQUIRE(b.backend.safe_output().sent_tick == b.tick);
}

TEST_CASE("a delayed channel of the device sends the counts of some periods before, and says nothing of it") {
  constexpr std::size_t periods = 7;
  Bench plain, delayed({}, {"delay:x:0.007@0.1"});
  const auto counts = [](Bench& b) { return b.device.nodes()[0]->dictionary().number(0x6020, 1); };
  std::vector<std::uint32_t> before;
  for (int i = 0; i < 300; ++i) {
    Measurement m;
    for (Bench* b : {&plain, &delayed}) {
      REQUIRE(b->backend.read(i, m));
      REQUIRE(b->backend.write(i, {2.0 * std::sin(0.05 * i)}));
    }
    REQUIRE((i == 0 || m.channel[Signal::x].age_s == Approx(delayed.rig.period_s).epsilon(1e-9)));
    before.push_back(counts(plain));
    const bool is_on = delayed.device.tick() >= 100;
    REQUIRE(counts(delayed) == (is_on ? before[before.size() - 1 - periods] : before.back()));
    for (Bench* b : {&plain, &delayed}) b->bus->advance(b->period_ns);
  }
  REQUIRE(before[290] != before[290 - periods]);  // it moves, or nothing would be seen
}

TEST_CASE("after bus-off nothing is sent until the user configures anew, then it goes on") {
  Bench b({}, {"bus_off@0.1"});
  REQUIRE(b.run(500) >= 0);
  b.bus->sent.clear();
  for (int i = 0; i < 20; ++i) b.step();
  REQUIRE(b.bus->sent.empty());
  REQUIRE(b.device.nodes()[1]->is_substituted() == false);
  b.bus->advance(100'000'000);
  REQUIRE(b.device.nodes()[1]->is_substituted());  // its own watchdog: our heartbeat is gone
  b.backend.deactivate();
  REQUIRE(b.bus->sent.empty());
  b.loop.rearm();
  b.backend.configure();
  b.backend.activate();
  b.tick = 0;
  REQUIRE(b.run(300) == -1);
  REQUIRE(b.device.nodes()[1]->is_substituted() == false);
}

TEST_CASE("a full queue is a missed output: it faults, and the old command is not sent again") {
  Bench b;
  REQUIRE(b.run(300) == -1);
  b.bus->sent.clear();
  b.bus->queue_is_full = true;
  b.step();
  REQUIRE((b.loop.first_faults() & fault_output_missed) != 0);
  REQUIRE(b.bus->sent.empty());
  b.bus->queue_is_full = false;
  b.step();
  for (const CanFrame& frame : b.bus->sent)
    if (frame.id == 0x302) REQUIRE(frame.data == std::array<std::uint8_t, 8>{});  // the safe output alone
}

TEST_CASE("the link that goes down is a fault and nothing else") {
  Bench b;
  REQUIRE(b.run(300) == -1);
  b.bus->up = false;
  b.step();
  REQUIRE((b.loop.first_faults() & fault_link_down) != 0);
}

TEST_CASE("when the controller dies the valve gets its substitute output within the watchdog") {
  Bench b({"safe_output.command_V=0.25"});
  for (int i = 0; i < 200; ++i) b.step();
  b.backend.read(200, *std::make_unique<Measurement>());
  b.backend.write(200, {3.0});
  REQUIRE(b.device.command_V() == Approx(3.0).margin(1e-3));
  b.bus->advance(100'000'000);  // no SYNC, no heartbeat any more
  REQUIRE(b.device.command_V() == Approx(0.25).margin(2e-4));
  REQUIRE(b.device.nodes()[1]->state() == NmtState::pre_operational);
}

TEST_CASE("what is wrong at the start is said in one sentence") {
  using Catch::Contains;
  const auto configure = [](const std::vector<std::string>& sets, const std::vector<std::string>& device_sets,
                            std::int64_t delay_ns = 200'000) {
    const Rig device_rig = can_rig(device_sets);
    PlantDevice device(device_rig);
    auto bus = std::make_unique<DeviceBus>(device);
    bus->delay_ns = delay_ns;
    CanBackend backend(can_rig(sets), std::move(bus));
    backend.configure();
    backend.activate();
  };
  REQUIRE_THROWS_WITH(configure({"hal.can.nodes.io.node_id=7"}, {}),
                      Contains("node io (7) did not come up within 2 s"));
  REQUIRE_THROWS_WITH(configure({"hal.can.nodes.io.profile=406"}, {"hal.can.nodes.io.profile=401"}),
                      Contains("states profile 401, expected 406"));
  REQUIRE_THROWS_WITH(configure({"hal.channels.p1_port.can.object=0x64010910"}, {}),
                      Contains("object 0x1a01:1: refused: no such object"));
  REQUIRE_THROWS_WITH(configure({"hal.channels.x.can.object=0x60040020"}, {}),
                      Contains("object 0x60040020 of channel x is not in the mapping 0x1a00"));
  REQUIRE_THROWS_WITH(configure({}, {}, 950'000), Contains("expected at most 900 us"));
  REQUIRE_THROWS_WITH(configure({"period_s=0.0002", "hal.can.heartbeat_s=0.02"}, {}), Contains("bus load"));
  REQUIRE_THROWS_WITH(PlantDevice(read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/cylinder-2m-6.10mm.yaml")),
                      Contains("hal.can: found nothing"));
}

TEST_CASE("a wiring that contradicts itself is refused with its line") {
  using Catch::Contains;
  const std::string io = "hal.channels.p1_port.can.";
  REQUIRE_THROWS_WITH(can_rig({io + "node=nonsense"}), Contains("p1_port.can.node: found 'nonsense'"));
  REQUIRE_THROWS_WITH(can_rig({io + "object=0x64010210"}), Contains("a second time at node io"));
  REQUIRE_THROWS_WITH(can_rig({io + "object=0x6401021"}), Contains("0x and eight hexadecimal digits"));
  REQUIRE_THROWS_WITH(can_rig({io + "object=0x64010240"}), Contains("0x and eight hexadecimal digits"));
  REQUIRE_THROWS_WITH(can_rig({io + "scale_Pa_per_count=0"}), Contains("expected the value of one count, not 0"));
  REQUIRE_THROWS_WITH(can_rig({io + "lowest_Pa=9e5"}), Contains("less than highest_Pa"));
  REQUIRE_THROWS_WITH(can_rig({io + "pdo=5"}), Contains("expected a whole number from 1 to 4"));
  REQUIRE_THROWS_WITH(can_rig({io + "scale_m_per_count=1"}), Contains("unknown key"));
  REQUIRE_THROWS_WITH(can_rig({"hal.channels.x.simulated=true"}), Contains("2 sources"));
  REQUIRE_THROWS_WITH(can_rig({"hal.can.nodes.encoder.node_id=2"}), Contains("node_id: found 2, which"));
  REQUIRE_THROWS_WITH(can_rig({"hal.can.watchdog_s=0.02"}), Contains("at least twice"));
  REQUIRE_THROWS_WITH(can_rig({"controller.pressure_source=chamber"}), Contains("hal.channels.p1_chamber"));
  REQUIRE_THROWS_WITH(can_rig({"safe_output.command_V=-5", "hal.channels.u.can.lowest_V=-4"}),
                      Contains("safe_output.command_V"));
}

TEST_CASE("bus load: an axis with full frames, two of them, and a lean one") {
  // With the worst stuffing SYNC 55, a frame of 8 bytes 135, of 6 bytes 115, of 4 bytes 95 us.
  REQUIRE(can_frame_bits_worst(0) == 55);
  REQUIRE(can_frame_bits_worst(1) == 65);
  REQUIRE(can_frame_bits_worst(4) == 95);
  REQUIRE(can_frame_bits_worst(6) == 115);
  REQUIRE(can_frame_bits_worst(8) == 135);
  // The shipped rig: SYNC 55, output of 2 bytes 75, pressures and readback of 8 bytes 135, the encoder's own mapping
  // counted as 8 bytes 135, and three heartbeats of 65 us in 20 ms.
  REQUIRE(bus_load(can_rig()).share == Approx((55 + 75 + 135 + 135) * 1e-3 + 3 * 65e-3 / 20).epsilon(1e-9));
  REQUIRE(bus_load(can_rig({"hal.can.bit_rate_bps=500000"})).share ==
          Approx(2 * bus_load(can_rig()).share).epsilon(1e-9));
  REQUIRE(bus_load(can_rig({"period_s=0.0002"})).share > 1.0);
}

TEST_CASE("configured: each channel from its source, and the others stay absent") {
  const Rig mixed = can_rig({"hal.can.interface=unix:/nonexistent/bus", "hal.channels.x={simulated: true}",
                             "hal.channels.p_supply={simulated: true}", "hal.bench=true"});
  CompositeBackend backend(mixed);
  const auto origins = backend.origins();
  REQUIRE(origins.command == Origin::real);
  REQUIRE(origins.channels[Signal::x] == Origin::simulated);
  REQUIRE(origins.channels[Signal::p_supply] == Origin::simulated);
  for (const Signal port : port_signals) REQUIRE(origins.channels[port] == Origin::real);
  for (const Signal chamber : chamber_signals) REQUIRE(origins.channels[chamber] == Origin::absent);
  REQUIRE_THROWS_WITH(backend.configure(), Catch::Contains("nobody listens there"));
  REQUIRE_THROWS_AS(CompositeBackend(read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/cylinder-2m-6.10mm.yaml")),
                    InputError);
}
