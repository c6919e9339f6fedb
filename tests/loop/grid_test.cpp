// Time grid: late ticks skip slots, the phase is never lost, the count is right.
#include <random>

#include <catch2/catch.hpp>

#include <pneuservo/loop/grid.hpp>

#include "core/test_seed.hpp"

using namespace pneuservo;

namespace {
constexpr std::int64_t start_ns = 1'000'000'007, period_ns = 1'000'000;
std::int64_t after_slot(const TimeGrid& grid, double periods) {
  return grid.slot_ns() + static_cast<std::int64_t>(periods * static_cast<double>(period_ns));
}
}  // namespace

TEST_CASE("a tick that is done in time goes to the next slot") {
  TimeGrid grid(start_ns, period_ns);
  REQUIRE(grid.slot() == 0);
  REQUIRE(grid.slot_ns() == start_ns);
  REQUIRE(grid.advance(after_slot(grid, 0.5)) == 0);
  REQUIRE(grid.slot() == 1);
  REQUIRE(grid.slot_ns() == start_ns + period_ns);
  REQUIRE(grid.missed() == 0);
}

TEST_CASE("a late tick skips to the first slot that is not past") {
  TimeGrid grid(start_ns, period_ns);
  SECTION("done exactly at the next slot: it is served") {
    REQUIRE(grid.advance(after_slot(grid, 1.0)) == 0);
    REQUIRE(grid.slot() == 1);
  }
  SECTION("one nanosecond later: it is skipped") {
    REQUIRE(grid.advance(after_slot(grid, 1.0) + 1) == 1);
    REQUIRE(grid.slot() == 2);
  }
  SECTION("3.2 periods: slots 1, 2, 3 are skipped") {
    REQUIRE(grid.advance(after_slot(grid, 3.2)) == 3);
    REQUIRE(grid.slot() == 4);
    REQUIRE(grid.slot_ns() == start_ns + 4 * period_ns);
  }
  SECTION("counts add up") {
    grid.advance(after_slot(grid, 3.2));
    grid.advance(after_slot(grid, 0.1));
    grid.advance(after_slot(grid, 2.5));
    REQUIRE(grid.missed() == 5);
    REQUIRE(grid.slot() == 8);
  }
  SECTION("a restart goes on a period from now, with the next number and nothing missed") {
    const std::int64_t now_ns = after_slot(grid, 1234.5);
    grid.restart(now_ns);
    REQUIRE(grid.slot() == 1);
    REQUIRE(grid.slot_ns() == now_ns + period_ns);
    REQUIRE(grid.missed() == 0);
  }
}

TEST_CASE("the phase is kept whatever the lateness") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937_64 random(seed);
  std::exponential_distribution<double> lateness_periods(1.0);
  TimeGrid grid(start_ns, 333'333);
  for (std::int64_t ticks = 1; ticks <= 100'000; ++ticks) {
    const std::int64_t now_ns = grid.slot_ns() + static_cast<std::int64_t>(lateness_periods(random) * 333'333);
    const std::int64_t skipped = grid.advance(now_ns);
    REQUIRE(grid.slot_ns() == start_ns + grid.slot() * 333'333);
    REQUIRE(grid.slot_ns() >= now_ns);
    if (skipped > 0) REQUIRE(grid.slot_ns() - now_ns < 333'333);
    REQUIRE(grid.slot() == ticks + grid.missed());
  }
}
