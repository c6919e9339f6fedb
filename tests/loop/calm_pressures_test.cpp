// Calm pressures in one pass say what four guards say, tick by tick, whatever the channels do.
#include <catch2/catch.hpp>

#include <cmath>
#include <random>

#include <pneuservo/loop/calm_pressures.hpp>

#include "core/test_seed.hpp"

using namespace pneuservo;

namespace {

constexpr double most_Pa = 9e5;

PerSignal<PlausibleChannel> plausible() {
  PerSignal<PlausibleChannel> all;
  for (const Signal signal : CalmPressures::signals)
    all[signal] = {.lowest = 1e4,
                   .highest = 1e6,
                   .slack = 500.0,
                   .step_per_period = 2e4,
                   .frozen_ticks = 3,
                   .oldest_s = 1e-3,
                   .period_s = 1e-3};
  return all;
}

/// The channels of a tick: nearly always a plausible step, now and then what a channel can do.
void next(std::mt19937& random, PerSignal<double>& truth_Pa, PerSignal<Channel>& channels, bool with_chambers) {
  const auto draw = [&](double from, double to) { return std::uniform_real_distribution(from, to)(random); };
  for (const Signal signal : CalmPressures::signals) {
    if (is_chamber(signal) && !with_chambers) continue;
    Channel& channel = channels[signal];
    channel.valid = true;
    channel.origin = Origin::real;
    channel.age_s = 2e-4;
    if (random() % 8 != 0) truth_Pa[signal] = std::clamp(truth_Pa[signal] + draw(-3e3, 3e3), 2e4, 9.2e5);
    channel.value = truth_Pa[signal];
    switch (random() % 400) {
      case 0: channel.valid = false; break;
      case 1: channel.age_s = 2e-3; break;
      case 2: channel.value = std::nan(""); break;
      case 3: channel.value += 4e4; break;
      case 4: channel.value = 2e6; break;
      case 5: channel.age_s = std::nan(""); break;
      default: break;
    }
  }
}

}  // namespace

TEST_CASE("calm pressures: values and findings of four guards, in whatever mixture of good and bad samples") {
  const unsigned seed = test::stated_seed().value_or(20261125u);
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 random(seed);
  const bool with_chambers = GENERATE(true, false);
  const PerSignal<PlausibleChannel> channels_may = plausible();
  PerSignal<InputGuard> guards, alone;
  PerSignal<bool> judged;
  for (const Signal signal : CalmPressures::signals) {
    guards[signal].configure(channels_may[signal]);
    alone[signal].configure(channels_may[signal]);
    judged[signal] = with_chambers || is_port(signal);
  }
  CalmPressures calm;
  calm.configure(channels_may, most_Pa);
  PerSignal<Channel> channels;
  PerSignal<double> truth_Pa;
  truth_Pa.all.fill(5e5);
  int calm_ticks = 0;
  const auto extra = [] { return 1e4; };
  for (int tick = 0; tick < 20000; ++tick) {
    next(random, truth_Pa, channels, with_chambers);
    const double periods = random() % 50 == 0 ? 3.0 : 1.0;
    CalmPressures::Four now;
    const bool is_calm = periods == 1.0 && calm.take(channels, judged, now);
    calm_ticks += is_calm;
    if (!is_calm) calm.leave(guards);
    for (std::size_t i = 0; i < CalmPressures::signals.size(); ++i) {
      const Signal signal = CalmPressures::signals[i];
      if (!judged[signal]) {
        if (is_calm) REQUIRE(std::isnan(now[static_cast<int>(i)]));
        continue;
      }
      const double expected = alone[signal].check(channels[signal], periods, extra);
      const double found = is_calm ? now[static_cast<int>(i)] : guards[signal].check(channels[signal], periods, extra);
      REQUIRE((found == expected || (std::isnan(found) && std::isnan(expected))));
      REQUIRE(alone[signal].finding() == (is_calm ? InputFinding::none : guards[signal].finding()));
      if (is_calm) REQUIRE(found <= most_Pa);
      REQUIRE(alone[signal].bad() == guards[signal].bad());
      REQUIRE(alone[signal].waiting() == guards[signal].waiting());
      if (!is_calm) REQUIRE(alone[signal].equal_ticks() == guards[signal].equal_ticks());
    }
    if (!is_calm) calm.begin(guards, judged);
  }
  REQUIRE(calm_ticks > 10000);
  REQUIRE(calm_ticks < 19000);
}

TEST_CASE("calm pressures: a chamber sensor that appears is no longer passed over") {
  PerSignal<InputGuard> guards;
  PerSignal<bool> judged;
  PerSignal<Channel> channels;
  const PerSignal<PlausibleChannel> may = plausible();
  for (const Signal signal : port_signals) {
    guards[signal].configure(may[signal]);
    judged[signal] = true;
    channels[signal] = {.value = 5e5, .age_s = 0.0, .valid = true, .origin = Origin::real};
    guards[signal].check(channels[signal]);
  }
  CalmPressures calm;
  calm.configure(may, most_Pa);
  calm.begin(guards, judged);
  CalmPressures::Four now;
  for (const Signal signal : port_signals) channels[signal].value += 100.0;
  REQUIRE(calm.take(channels, judged, now));
  for (const Signal signal : port_signals) channels[signal].value += 100.0;
  channels[Signal::p1_chamber].origin = Origin::real;
  REQUIRE_FALSE(calm.take(channels, judged, now));
}
