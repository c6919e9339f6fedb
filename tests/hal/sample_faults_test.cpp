// Injected faults of samples: each kind, their order, and what skipped ticks and a first sample do to them.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "inject/sample_faults.hpp"

using namespace pneuservo;

namespace {

constexpr double fault_period_s = 0.001;

/// A position that is its tick, in m; the other channels are absent.
struct Samples {
  SampleFaults faults{fault_period_s, {1e9, 0, 0, 0, 0, 0}};
  Samples(std::initializer_list<const char*> orders) {
    for (const char* order : orders) faults.add(parse_fault_order(order, 0.0));
  }
  Channel at(std::int64_t tick) {
    Measurement measured;
    measured.channel[Signal::x] = {static_cast<double>(tick), 0.5 * fault_period_s, true, Origin::simulated};
    faults.apply(tick, static_cast<double>(tick) * fault_period_s, measured);
    return measured.channel[Signal::x];
  }
};

}  // namespace

TEST_CASE("each kind spoils its sample while it is on and no other") {
  struct Case {
    const char* order;
    double value;
    bool valid;
  };
  const Case c = GENERATE(Case{"bias:x:0.5@0.005+0.0015", 5.5, true}, Case{"freeze:x@0.005+0.0015", 4, true},
                          Case{"saturate:x@0.005+0.0015", 1e9, true}, Case{"saturate:x:-3@0.005+0.0015", -3, true},
                          Case{"spike:x:2@0.005+0.0015", 7, true}, Case{"drop:x@0.005+0.0015", 5, false},
                          Case{"encoder_jump:0.1@0.005+0.0015", 5.1, true}, Case{"bias:p1_port:1@0.005", 5, true});
  INFO(c.order);
  Samples samples({c.order});
  for (int tick = 0; tick < 5; ++tick) REQUIRE((samples.at(tick).value == tick));
  const Channel spoiled = samples.at(5);
  REQUIRE(spoiled.value == c.value);
  REQUIRE(spoiled.valid == c.valid);
  samples.at(6);
  REQUIRE(samples.at(7).value == 7.0);
  REQUIRE(samples.at(8).valid);
}

TEST_CASE("a sample that is not a number is none from its tick on") {
  Samples samples({"nan:x@0.005"});
  REQUIRE(samples.at(4).value == 4.0);
  REQUIRE(std::isnan(samples.at(5).value));
}

TEST_CASE("a spike is one sample, whichever comes first after its time") {
  Samples samples({"spike:x:100@0.005"});
  REQUIRE(samples.at(4).value == 4.0);
  REQUIRE(samples.at(8).value == 108.0);  // ticks 5 to 7 were skipped
  REQUIRE(samples.at(9).value == 9.0);
  samples.faults.reset();
  REQUIRE(samples.at(5).value == 105.0);
}

TEST_CASE("a delay counts periods over skipped ticks, tells its age, and has the first sample before any other") {
  Samples samples({"delay:x:0.003"});
  REQUIRE(samples.at(10).value == 10.0);
  REQUIRE(samples.at(11).value == 10.0);
  for (int tick = 12; tick < 20; ++tick) {
    const Channel sample = samples.at(tick);
    REQUIRE(sample.value == std::max(tick - 3, 10));
    REQUIRE(sample.age_s == Approx(3.5 * fault_period_s));
  }
  REQUIRE(samples.at(25).value == 19.0);  // at tick 22 the newest one was of tick 19
  REQUIRE(samples.at(27).value == 19.0);
  REQUIRE(samples.at(28).value == 25.0);
}

TEST_CASE("a channel that is frozen from the start keeps its first sample, one frozen on command its last") {
  Samples from_start({"freeze:x"});
  REQUIRE(from_start.at(3).value == 3.0);
  REQUIRE(from_start.at(4).value == 3.0);
  Samples on_command({});
  on_command.at(6);
  on_command.faults.add(parse_fault_order("freeze:x", 0.006));
  REQUIRE(on_command.at(7).value == 6.0);
  REQUIRE(on_command.at(8).value == 6.0);
  Samples spoiled_before({"bias:x:0.5"});
  spoiled_before.at(6);
  spoiled_before.faults.add(parse_fault_order("freeze:x", 0.006));
  REQUIRE(spoiled_before.at(7).value == 6.5);  // what was shown, not what was measured
}

TEST_CASE("faults of one channel act in their order") {
  REQUIRE(Samples({"saturate:x:1", "bias:x:0.5"}).at(2).value == 1.5);
  REQUIRE(Samples({"bias:x:0.5", "saturate:x:1"}).at(2).value == 1.0);
}

TEST_CASE("wrong wiring turns the encoder round and exchanges the port sensors, hoses under them too") {
  struct Case {
    const char* order;
    double position, port_1, port_2;
  };
  const Case c = GENERATE(Case{"reversed_encoder@0.002", -3, 1e5, 2e5}, Case{"exchanged_ports@0.002", 3, 2e5, 1e5},
                          Case{"exchanged_hoses@0.002", 3, 2e5, 1e5}, Case{"reversed_valve@0.002", 3, 1e5, 2e5},
                          Case{"reversed_encoder@0.004", 3, 1e5, 2e5});
  INFO(c.order);
  SampleFaults faults(fault_period_s, {});
  faults.add(parse_fault_order(c.order, 0.0));
  Measurement measured;
  measured.channel[Signal::x] = {3.0, 0.0, true, Origin::simulated};
  measured.channel[Signal::p1_port] = {1e5, 0.0, true, Origin::simulated};
  measured.channel[Signal::p2_port] = {2e5, 0.0, true, Origin::simulated};
  faults.apply(3, 3.0 * fault_period_s, measured);
  REQUIRE(measured.channel[Signal::x].value == c.position);
  REQUIRE(measured.channel[Signal::p1_port].value == c.port_1);
  REQUIRE(measured.channel[Signal::p2_port].value == c.port_2);
}
