// The guard of one channel: spikes are bridged, failures are named, and rest, quanta and overruns are no failures.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/sensor.hpp>
#include <pneuservo/loop/input_guard.hpp>
#include <pneuservo/rig/possible_values.hpp>

using namespace pneuservo;

namespace {

Channel good(double value) { return {value, 0.0, true, Origin::real}; }
Channel absent() { return {1.0, 0.0, false, Origin::real}; }
const PlausibleChannel position{
    .lowest = -0.3, .highest = 0.3, .slack = 1e-5, .step_per_period = 5e-3, .stopping_step = 1e-4, .start_ticks = 100};

InputGuard started(double value, const PlausibleChannel& plausible = position) {
  InputGuard guard;
  guard.configure(plausible);
  guard.check(good(value));
  return guard;
}

}  // namespace

TEST_CASE("a bad sample is replaced for two ticks, the third is a fault") {
  const auto bad =
      GENERATE(absent(), good(std::nan("")), good(0.4), good(-0.4), good(std::numeric_limits<double>::infinity()));
  InputGuard guard = started(0.1);
  for (int i = 0; i < 2; ++i) {
    REQUIRE(guard.check(bad) == 0.1);
    REQUIRE(guard.finding() == InputFinding::bridged);
  }
  SECTION("it comes back") {
    REQUIRE(guard.check(good(0.101)) == 0.101);
    REQUIRE(guard.finding() != InputFinding::missing);
    // and the count begins anew
    guard.check(bad);
    guard.check(bad);
    REQUIRE(guard.finding() != InputFinding::missing);
  }
  SECTION("it stays away") {
    REQUIRE(guard.check(bad) == 0.1);
    REQUIRE(guard.finding() == InputFinding::missing);
    REQUIRE(guard.finding() != InputFinding::jumped);
  }
}

TEST_CASE("a jump is bridged, one that stays is a fault of its own") {
  InputGuard guard = started(0.0);
  REQUIRE(guard.check(good(0.1)) == 0.0);
  REQUIRE(guard.check(good(0.1)) == 0.0);
  REQUIRE(guard.finding() != InputFinding::jumped);
  guard.check(good(0.1));
  REQUIRE(guard.finding() == InputFinding::jumped);
  REQUIRE(guard.finding() != InputFinding::missing);
}

TEST_CASE("what a channel may move grows with the periods since its last sample") {
  InputGuard guard = started(0.0);
  REQUIRE(guard.check(good(0.04), 9.0) == 0.04);  // eight slots skipped
  REQUIRE(guard.check(good(0.08)) == 0.04);       // none skipped: impossible
  guard.check(absent());
  REQUIRE(guard.check(good(0.054)) == 0.054);     // three periods after the last good sample
  REQUIRE(guard.check(good(0.08), 1.0, [] { return 0.03; }) == 0.08);  // the caller knows of more
}

TEST_CASE("a mass cannot gain speed at once, but lose it") {
  PlausibleChannel plausible = position;
  plausible.step_growth = 1e-3;
  InputGuard guard = started(0.0, plausible);
  REQUIRE(guard.check(good(0.002)) == 0.0);       // 2 mm from rest: a spike
  REQUIRE(guard.check(good(0.0005)) == 0.0005);
  REQUIRE(guard.check(good(0.0017)) == 0.0017);   // 0.25 mm the period before, and 1 mm more
  REQUIRE(guard.check(good(0.0017)) == 0.0017);
  REQUIRE(guard.check(good(0.0058)) == 0.0017);
  REQUIRE(guard.finding() != InputFinding::jumped);
}

TEST_CASE("before the first value a channel is waited for, then missing") {
  InputGuard guard;
  guard.configure(position);
  for (int i = 0; i < 100; ++i) {
    REQUIRE(std::isnan(guard.check(absent())));
    REQUIRE(guard.waiting());
    REQUIRE(guard.finding() != InputFinding::missing);
  }
  guard.check(absent());
  REQUIRE(guard.finding() == InputFinding::missing);
  guard.reset();
  REQUIRE(guard.finding() != InputFinding::missing);
  REQUIRE(guard.check(good(0.2)) == 0.2);
  REQUIRE_FALSE(guard.waiting());
}

TEST_CASE("a position that stops dead out of full motion is frozen, one that comes to rest is not") {
  InputGuard guard = started(0.0);
  double x = 0.0, v = 5e-4;
  for (int i = 0; i < 50; ++i) guard.check(good(x += v));
  SECTION("dead stop") {
    for (int i = 0; i < InputGuard::stopped_ticks - 1; ++i) {
      guard.check(good(x));
      REQUIRE(guard.finding() != InputFinding::frozen);
    }
    guard.check(good(x));
    REQUIRE(guard.finding() == InputFinding::frozen);
  }
  SECTION("dead stop at an end stop, and rest there for long, also after the slider is no longer said to be there") {
    for (int i = 0; i < 500; ++i) {
      guard.check(good(x), 1.0, [] { return 0.0; }, i < 400);
      REQUIRE(guard.finding() != InputFinding::frozen);
    }
  }
  SECTION("slows down as friction does") {
    for (; v > 0.0; v -= 2e-6) guard.check(good(x += v));
    for (int i = 0; i < 5000; ++i) {
      guard.check(good(x));
      REQUIRE(guard.finding() != InputFinding::frozen);
    }
  }
  SECTION("a late tick carries a long way and is no fast motion") {
    for (int i = 0; i < 40; ++i) guard.check(good(x += 5e-6));
    guard.check(good(x += 5e-4), 11.0);
    for (int i = 0; i < 50; ++i) {
      guard.check(good(x));
      REQUIRE(guard.finding() != InputFinding::frozen);
    }
  }
}

TEST_CASE("equal samples prove nothing about a sensor without noise or with a coarse quantum") {
  REQUIRE(frozen_after_ticks(0.0, 100.0) == 0);
  REQUIRE(frozen_after_ticks(0.0, 0.0) == 0);
  REQUIRE(frozen_after_ticks(10.0, 100.0) == 0);
  REQUIRE(frozen_after_ticks(1.0, 100.0) == 0);  // to the last bit no sample leaves the quantum
  REQUIRE(frozen_after_ticks(300.0, 0.0) == 20);
  REQUIRE(frozen_after_ticks(300.0, 100.0) == 20);
  const int half = frozen_after_ticks(50.0, 100.0);
  REQUIRE(half > 60);
  REQUIRE(half < 90);
}

TEST_CASE("a resting sensor with noise is never frozen, a stuck one always is") {
  const auto [noise, quantum] = GENERATE(table<double, double>(
      {{300.0, 100.0}, {100.0, 100.0}, {50.0, 100.0}, {30.0, 100.0}, {20.0, 100.0}, {0.0, 100.0}, {5.0, 0.0}}));
  const auto value = GENERATE(500'000.0, 500'050.0, 500'017.0);  // middle and edge of a quantum, and between
  const std::uint64_t seed = 20250817;
  CAPTURE(noise, quantum, value, seed);
  Sensor sensor;
  sensor.configure({}, quantum, noise, 1e-3, Random(seed, 0));
  sensor.reset(value);
  const int ticks = frozen_after_ticks(noise, quantum);
  const PlausibleChannel pressure{
      .lowest = 3e4, .highest = 1e6, .slack = 6.0 * noise + quantum, .step_per_period = 35e3, .frozen_ticks = ticks};
  InputGuard guard = started(value, pressure);
  for (int i = 0; i < 300'000; ++i) {
    guard.check(good(sensor.read(value)));
    if (!guard.good()) FAIL("a healthy sensor was blamed at tick " << i);
  }
  if (ticks == 0) return;
  const double stuck = sensor.read(value);
  for (int i = 0; i <= ticks; ++i) guard.check(good(stuck));
  REQUIRE(guard.finding() == InputFinding::frozen);
}
