// The planner of set points at run time: random re-plans stay within limits, end exactly, and are smooth.
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <random>

#include <pneuservo/control/live_planner.hpp>

#include "core/test_seed.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

LiveLimits drawn_limits(std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  LiveLimits limits;
  limits.lowest_m = -uniform(0.02, 0.5);
  limits.highest_m = uniform(0.02, 0.5);
  limits.speed_mps = uniform(0.02, 2.0);
  limits.acceleration_mps2 = limits.speed_mps * std::exp(uniform(0.0, 4.0));
  limits.smoothness = 5 + 2 * static_cast<int>(random() % 4);
  return limits;
}

/// Asks for one random thing at that tick; false: there was no room.
bool ask(LivePlanner& planner, std::int64_t tick, std::mt19937_64& random) {
  const LiveLimits& limits = planner.limits();
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const double speed = uniform(0.001, 1.5) * limits.speed_mps;  // beyond the limit, too
  const double wide = 1.2 * std::max(limits.highest_m, -limits.lowest_m);
  switch (random() % 8) {
    case 0: return planner.stop(tick);
    case 1: return planner.jog(tick, random() % 2 == 0 ? speed : -speed);
    case 2: return planner.move_to(tick, planner.target_m() + uniform(-1e-3, 1e-3), speed);
    case 3: return planner.move_to(tick, planner.at(tick).d[0], speed);
    default: return planner.move_to(tick, uniform(-wide, wide), speed);
  }
}

void require_within(const LivePlanner& planner, const ReferencePoint& point) {
  const LiveLimits& limits = planner.limits();
  const double rounding = 1e-12;
  REQUIRE(point.d[0] >= limits.lowest_m - rounding);
  REQUIRE(point.d[0] <= limits.highest_m + rounding);
  REQUIRE(std::fabs(point.d[1]) <= limits.speed_mps * (1.0 + rounding));
  REQUIRE(std::fabs(point.d[2]) <= limits.acceleration_mps2 * (1.0 + 1e-9));
}

/// Largest sum of |terms| of a derivative: its rounding is a share of it.
double scale_of(const LivePlanner& planner, int order, double period_s) {
  const double transition_s = static_cast<double>(planner.transition()) * period_s;
  return planner.limits().speed_mps * 1e4 * std::pow(12.0 / transition_s, order - 1);
}

}  // namespace

TEST_CASE("random re-plans never leave position, speed and acceleration, and end exactly") {
  const auto seed = new_seed();
  CAPTURE(seed);
  std::mt19937_64 random(seed);
  const long re_plans = std::getenv("PNEUSERVO_LONG") != nullptr ? 1'000'000 : 50'000;
  constexpr double period_s = 1e-3;
  long asked = 0, refused = 0;
  while (asked < re_plans) {
    LivePlanner planner;
    const LiveLimits limits = drawn_limits(random);
    planner.configure(limits, period_s);
    std::int64_t tick = static_cast<std::int64_t>(random() % 1'000'000'000);
    planner.start(tick, std::uniform_real_distribution<double>(limits.lowest_m, limits.highest_m)(random));
    const std::int64_t longest_wait = 1 + static_cast<std::int64_t>(random() % (3 * planner.transition()));
    for (int i = 0; i < 50; ++i, ++asked) {
      refused += ask(planner, tick, random) ? 0 : 1;
      const std::int64_t until = tick + 1 + static_cast<std::int64_t>(random() % longest_wait);
      const std::int64_t stride = std::max<std::int64_t>((until - tick) / 8, 1);
      for (; tick < until; tick += stride) {
        planner.pass(tick);
        require_within(planner, planner.at(tick));
        require_within(planner, planner.at(tick, 0.37 * static_cast<double>(stride)));
      }
    }
    // Whatever was planned last ends there and rests.
    const std::int64_t end = std::max(planner.end_tick(), tick);
    for (std::int64_t step = 0; step <= 20; ++step)
      require_within(planner, planner.at(tick + (end - tick) * step / 20));
    const ReferencePoint planned = planner.at(end);
    REQUIRE(std::fabs(planned.d[0] - planner.target_m()) < 1e-12);
    planner.pass(end);
    const ReferencePoint there = planner.at(end);
    REQUIRE(there.d[0] == planner.target_m());
    for (std::size_t order = 1; order < there.d.size(); ++order) REQUIRE(there.d[order] == 0.0);
  }
  INFO(refused << " of " << asked << " had no room");
  CHECK(refused < asked / 4);
}

TEST_CASE("a re-plan changes nothing of the present, and derivatives up to the sixth are continuous") {
  const auto seed = new_seed();
  CAPTURE(seed);
  std::mt19937_64 random(seed);
  constexpr double period_s = 1e-3;
  for (int machine = 0; machine < 200; ++machine) {
    LivePlanner planner;
    LiveLimits limits = drawn_limits(random);
    limits.smoothness = 11;
    planner.configure(limits, period_s);
    planner.start(0, 0.0);
    std::int64_t tick = 0;
    for (int i = 0; i < 30; ++i) {
      tick += 1 + static_cast<std::int64_t>(random() % planner.transition());
      planner.pass(tick);
      const ReferencePoint before = planner.at(tick);
      ask(planner, tick, random);
      const ReferencePoint after = planner.at(tick);
      for (std::size_t order = 0; order <= 6; ++order)
        REQUIRE(std::fabs(after.d[order] - before.d[order]) <=
                1e-13 * scale_of(planner, static_cast<int>(order), period_s));
    }
  }
}

TEST_CASE("each derivative of the planner is the slope of the one before") {
  LivePlanner planner;
  planner.configure({-0.2, 0.2, 0.5, 3.0, 11}, 1e-3);
  planner.start(0, 0.0);
  REQUIRE(planner.move_to(0, 0.15, 0.5));
  REQUIRE(planner.move_to(150, 0.12, 0.3));
  REQUIRE(planner.move_to(200, -0.1, 0.4));
  const double h = 1e-2;  // periods
  for (int i = 1; i < 3000; ++i) {
    const double t = 0.731 * i;
    const auto low = planner.at(0, t - h), high = planner.at(0, t + h), mid = planner.at(0, t);
    for (std::size_t order = 0; order < 6; ++order) {
      const double slope = (high.d[order] - low.d[order]) / (2.0 * h * 1e-3);
      INFO("order " << order << " at tick " << t);
      REQUIRE(std::fabs(slope - mid.d[order + 1]) <= 1e-9 * scale_of(planner, static_cast<int>(order) + 1, 1e-3));
    }
  }
}

TEST_CASE("a move takes the way at its speed and one transition, a turn rests one transition in between") {
  LivePlanner planner;
  planner.configure({-0.2, 0.2, 0.5, 5.0, 11}, 1e-3);
  planner.start(0, 0.0);
  REQUIRE(planner.move_to(0, 0.1, 0.2));
  CHECK(planner.end_tick() == 500 + planner.transition());
  CHECK(planner.at(300).d[1] == Approx(0.2));
  REQUIRE(planner.move_to(300, 0.0, 0.2));
  CHECK(planner.at(300 + planner.transition()).d[1] == Approx(0.0).margin(1e-12));
  CHECK(planner.end_tick() == 300 + planner.transition() + 300 + planner.transition());
  // Twice the acceleration or half the speed: half the transition.
  CHECK(LivePlanner::transition_s({-1, 1, 0.5, 10.0, 11}) ==
        Approx(0.5 * LivePlanner::transition_s({-1, 1, 0.5, 5.0, 11})));
  CHECK(LivePlanner::transition_s({-1, 1, 0.5, 5.0, 3}) == Approx(1.5 * 0.1));
}

TEST_CASE("a stop comes to rest half a transition at the speed ahead, a start outside comes back and jogs no further") {
  LivePlanner planner;
  planner.configure({-0.1, 0.1, 0.5, 5.0, 11}, 1e-3);
  planner.start(0, -0.1);
  REQUIRE(planner.jog(0, 0.25));
  const double there = planner.at(400).d[0];
  REQUIRE(planner.stop(400));
  const double half_s = 0.5e-3 * static_cast<double>(planner.transition());
  CHECK(planner.at(planner.end_tick()).d[0] == Approx(there + 0.25 * half_s));
  planner.start(1000, 0.12);
  REQUIRE(planner.jog(1000, 0.2));
  CHECK(planner.at(5000).d[0] == 0.12);
  REQUIRE(planner.move_to(5000, 0.3, 0.2));
  CHECK(planner.at(planner.end_tick()).d[0] == Approx(0.1).margin(1e-15));
}
