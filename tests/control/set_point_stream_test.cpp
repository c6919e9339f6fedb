// Streams of set points: whatever comes, the motion stays within limits, is smooth, and rests where the stream ends.
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include <pneuservo/control/set_point_stream.hpp>

#include "core/test_seed.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

constexpr double stream_period_s = 1e-3;

LiveLimits usual_limits() { return {-0.12, 0.12, 0.4, 3.0, 11}; }

/// The stream, with a set point every `interval` ticks; ends with a rest.
std::vector<ReferencePoint> played(SetPointStream& stream, const std::vector<double>& set_points, int interval) {
  std::vector<ReferencePoint> points;
  std::int64_t tick = 0;
  const auto run = [&](std::int64_t ticks) {
    for (std::int64_t i = 0; i < ticks; ++i) {
      stream.advance(++tick, 1e9);
      points.push_back(stream.now());
    }
  };
  for (const double set_point : set_points) {
    stream.go(set_point, interval);
    run(interval);
  }
  while (!stream.rests()) run(1);
  return points;
}

/// Of derivative m: what the limits let it be at most, within a small factor.
double scale_of(const SetPointStream& stream, const LiveLimits& limits, std::size_t order) {
  const double length_s = static_cast<double>(stream.cascade()) * stream_period_s / 6.0;
  return limits.speed_mps / std::pow(length_s, static_cast<double>(order) - 1.0);
}

}  // namespace

TEST_CASE("random streams never leave position, speed and acceleration, and end exactly") {
  const auto seed = new_seed();
  CAPTURE(seed);
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const int machines = std::getenv("PNEUSERVO_LONG") != nullptr ? 3000 : 150;
  for (int machine = 0; machine < machines; ++machine) {
    LiveLimits limits{-uniform(0.02, 0.5), uniform(0.02, 0.5), uniform(0.02, 2.0), 0.0,
                      5 + 2 * static_cast<int>(random() % 4)};
    limits.acceleration_mps2 = limits.speed_mps * std::exp(uniform(0.0, 4.0));
    SetPointStream stream;
    stream.configure(limits, stream_period_s, 0.0);
    stream.start(0, 0.0);
    const int interval = 1 + static_cast<int>(random() % 40);
    std::vector<double> set_points;
    double at = 0.0, speed = 0.0;
    for (int i = 0; i < 400; ++i) {  // walks, jumps, rests and set points outside
      if (random() % 20 == 0) speed = uniform(-3.0, 3.0) * limits.speed_mps;
      at = random() % 50 == 0 ? uniform(-1.0, 1.0) : std::clamp(at + speed * interval * stream_period_s, -0.6, 0.6);
      set_points.push_back(at);
    }
    for (const ReferencePoint& point : played(stream, set_points, interval)) {
      REQUIRE(point.d[0] >= limits.lowest_m - 1e-12);
      REQUIRE(point.d[0] <= limits.highest_m + 1e-12);
      REQUIRE(std::fabs(point.d[1]) <= limits.speed_mps * (1.0 + 1e-9) + 2.0 * limits.unit_m / stream_period_s);
      REQUIRE(std::fabs(point.d[2]) <= limits.acceleration_mps2 * (1.0 + 1e-6));
    }
    const ReferencePoint end = stream.now();
    CHECK(std::fabs(end.d[0] - std::clamp(at, limits.lowest_m, limits.highest_m)) <= 0.5 * limits.unit_m);
    for (std::size_t order = 1; order < end.d.size(); ++order) CHECK(end.d[order] == 0.0);
  }
}

TEST_CASE("derivatives of a stream up to the sixth are continuous, and each is the slope of the one before") {
  const LiveLimits limits = usual_limits();
  SetPointStream stream;
  stream.configure(limits, stream_period_s, 0.0);
  stream.start(0, 0.0);
  std::mt19937_64 random(new_seed());
  std::vector<double> set_points;
  for (int i = 0; i < 300; ++i) set_points.push_back(std::uniform_real_distribution<double>(-0.1, 0.1)(random));
  const auto points = played(stream, set_points, 10);
  const double per_length = 1.0 / (static_cast<double>(stream.cascade()) / 6.0);
  for (std::size_t i = 1; i < points.size(); ++i)
    for (std::size_t order = 0; order < 6; ++order) {
      const double change = points[i].d[order] - points[i - 1].d[order];
      const double mean = 0.5 * (points[i].d[order + 1] + points[i - 1].d[order + 1]);
      INFO("order " << order << " at " << i);
      // The trapezoid's share of the next two orders, and what rounding to the unit leaves.
      REQUIRE(std::fabs(change - mean * stream_period_s) <=
              stream_period_s * scale_of(stream, limits, order + 1) * 64.0 * per_length * per_length +
                  4e-12 / stream_period_s * 1e-3);
    }
  for (std::size_t i = 1; i < points.size(); ++i)
    REQUIRE(std::fabs(points[i].d[6] - points[i - 1].d[6]) <= 64.0 * scale_of(stream, limits, 7) * stream_period_s);
}

TEST_CASE("a stream within the limits is followed half a cascade later, however its set points are spaced") {
  for (const int interval : {1, 4, 10, 33}) {
    SetPointStream stream;
    stream.configure(usual_limits(), stream_period_s, 0.0);
    stream.start(0, 0.0);
    std::vector<double> set_points;
    for (int i = 1; i <= 800 / interval; ++i) set_points.push_back(0.1 * stream_period_s * interval * i);
    const auto points = played(stream, set_points, interval);
    const std::size_t i = 600;  // ticks; both ends are a cascade away
    CHECK(points[i].d[0] ==
          Approx(0.1 * (static_cast<double>(i + 1) * stream_period_s - stream.delay_s())).margin(1e-11));
    CHECK(points[i].d[1] == Approx(0.1).epsilon(1e-9));
    CHECK(points[i].d[2] == Approx(0.0).margin(1e-8));
    CHECK_FALSE(stream.is_late());
    CHECK(points.back().d[0] == Approx(set_points.back()).margin(1e-12));
  }
}

TEST_CASE("a stream that is too fast is late, and caught up with") {
  SetPointStream stream;
  stream.configure(usual_limits(), stream_period_s, 0.0);
  stream.start(0, -0.1);
  stream.go(0.1, 100);  // 2 m/s
  for (int tick = 1; tick <= 100; ++tick) stream.advance(tick, 1e9);
  CHECK(stream.is_late());
  const std::int64_t end = stream.end_tick();
  for (std::int64_t tick = 101; tick <= end; ++tick) stream.advance(tick, 1e9);
  CHECK(stream.rests());
  CHECK_FALSE(stream.is_late());
  CHECK(stream.now().d[0] == Approx(0.1).margin(1e-12));
  // A speed that is held for the start's proof holds the line, too.
  stream.go(0.0, 10);
  double fastest = 0.0;
  for (std::int64_t tick = end + 1; tick <= end + 3000; ++tick) {
    stream.advance(tick, 0.1);
    fastest = std::max(fastest, std::fabs(stream.now().d[1]));
  }
  CHECK(fastest == Approx(0.1).epsilon(1e-6));
  CHECK(stream.now().d[0] == Approx(0.0).margin(1e-12));
}

TEST_CASE("what is ahead of a stream comes true after the lead") {
  const double lead_s = 7.3e-3;
  SetPointStream stream, without;
  stream.configure(usual_limits(), stream_period_s, lead_s);
  without.configure(usual_limits(), stream_period_s, 0.0);
  stream.start(0, 0.0);
  without.start(0, 0.0);
  std::vector<ReferencePoint> ahead, undelayed;
  for (int tick = 1; tick <= 900; ++tick) {
    const double set_point = 0.05 * std::sin(6.0 * tick * stream_period_s);
    for (SetPointStream* s : {&stream, &without}) {
      if (tick % 10 == 1) s->go(set_point, 10);
      s->advance(tick, 1e9);
    }
    ahead.push_back(stream.ahead());
    undelayed.push_back(without.now());
    if (tick > 8) CHECK(stream.now().d[0] == undelayed[static_cast<std::size_t>(tick - 9)].d[0]);
  }
  // 7.3 periods ahead of what is 8 behind: 0.7 behind the newest.
  for (std::size_t i = 1; i < ahead.size(); ++i)
    for (std::size_t order = 0; order < 4; ++order) {
      const double between = 0.7 * undelayed[i - 1].d[order] + 0.3 * undelayed[i].d[order];
      CHECK(ahead[i].d[order] == Approx(between).margin(1e-3 * scale_of(without, usual_limits(), order)));
    }
}
