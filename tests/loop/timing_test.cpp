// Histograms of times: bins, percentiles with known answers; the worst cycles.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include <pneuservo/loop/timing.hpp>

#include "core/test_seed.hpp"

using namespace pneuservo;

TEST_CASE("bins cover the times without gap or overlap, at most 1.6 % wide") {
  std::int64_t lower_ns = 0;
  for (int bin = 0; bin < TimeHistogram::bins; ++bin) {
    const std::int64_t upper_ns = TimeHistogram::upper_ns(bin);
    REQUIRE(TimeHistogram::bin_of(lower_ns) == bin);
    REQUIRE(TimeHistogram::bin_of(upper_ns) == bin);
    REQUIRE(upper_ns - lower_ns <= lower_ns / 64);
    lower_ns = upper_ns + 1;
  }
  REQUIRE(lower_ns == TimeHistogram::limit_ns);
}

TEST_CASE("percentiles of known counts") {
  TimeHistogram histogram;
  REQUIRE(histogram.percentile_us(0.5) == 0.0);
  SECTION("1 to 100 ns are exact") {
    for (int time_ns = 1; time_ns <= 100; ++time_ns) histogram.add(time_ns);
    REQUIRE(histogram.percentile_us(0.50) == Approx(0.050));
    REQUIRE(histogram.percentile_us(0.99) == Approx(0.099));
    REQUIRE(histogram.percentile_us(1.0) == Approx(0.100));
    REQUIRE(histogram.mean_us() == Approx(0.0505));
  }
  SECTION("one long time shows at its percentile and as the maximum") {
    for (int i = 0; i < 9999; ++i) histogram.add(10'000);
    histogram.add(5'000'000);
    REQUIRE(histogram.percentile_us(0.9999) == Approx(10.0).epsilon(1.0 / 64));
    REQUIRE(histogram.percentile_us(0.99995) == 5000.0);
    REQUIRE(histogram.maximum_us() == 5000.0);
  }
  SECTION("negative counts as 0, more than a second as the last bin") {
    histogram.add(-5);
    histogram.add(3'000'000'000);
    REQUIRE(histogram.bin_count(0) == 1);
    REQUIRE(histogram.bin_count(TimeHistogram::bins - 1) == 1);
    REQUIRE(histogram.percentile_us(1.0) == 3e6);
  }
}

TEST_CASE("percentiles are those of the sorted times to the bin's width") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937_64 random(seed);
  std::lognormal_distribution<double> time_ns(9.0, 2.0);
  std::vector<std::int64_t> times(20'000);
  TimeHistogram first, histogram;
  for (std::size_t i = 0; i < times.size(); ++i) {
    times[i] = static_cast<std::int64_t>(time_ns(random));
    (i % 2 == 0 ? first : histogram).add(times[i]);
  }
  histogram.add(first);
  std::sort(times.begin(), times.end());
  for (const double quantile : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const auto index = static_cast<std::size_t>(std::ceil(quantile * 20'000) - 1);
    const double exact_us = static_cast<double>(times[index]) * 1e-3;
    REQUIRE(histogram.percentile_us(quantile) >= exact_us);
    REQUIRE(histogram.percentile_us(quantile) <= exact_us * (1 + 1.0 / 64));
  }
}

TEST_CASE("the 16 worst cycles are kept") {
  LoopTiming timing;
  for (std::int64_t tick = 0; tick < 1000; ++tick) timing.keep_worst({tick, tick * 7919 % 1000, 1});
  std::vector<std::int64_t> kept;
  for (const WorstCycle& cycle : timing.worst) kept.push_back(cycle.lateness_ns);
  std::sort(kept.begin(), kept.end());
  for (int i = 0; i < 16; ++i) REQUIRE(kept[static_cast<std::size_t>(i)] == 984 + i);
}
