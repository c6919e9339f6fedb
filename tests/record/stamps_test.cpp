// Stamps of other loggers: interval under jitter, losses and rounding; runs where the time goes back.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/test_seed.hpp"
#include "record/files.hpp"
#include "record/foreign/stamps.hpp"
#include "record/import.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

std::vector<double> even_times(int count, double interval_s, double start_s = 0) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(start_s + i * interval_s);
  return out;
}

}  // namespace

TEST_CASE("the interval is found under jitter, losses, gaps and rounding") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const double interval_s = 1e-3 * (0.2 + 19 * uniform(generator));
  const std::vector<double> even = even_times(3000, interval_s);
  CHECK(interval_of(even) == Approx(interval_s).epsilon(1e-9));

  std::vector<double> jittered(even);
  for (double& t : jittered) t += 0.1 * interval_s * normal(generator);
  CHECK(interval_of(jittered) == Approx(interval_s).epsilon(1e-4));

  std::vector<double> lossy;
  for (const double t : even)
    if (uniform(generator) > 0.03) lossy.push_back(t);
  CHECK(interval_of(lossy) == Approx(interval_s).epsilon(1e-9));

  std::vector<double> gap(even.begin(), even.begin() + 1000);
  gap.insert(gap.end(), even.begin() + 1700, even.end());
  for (std::size_t i = 1500; i < gap.size(); ++i) gap[i] += 3600;  // a clock that was set
  CHECK(interval_of(gap) == Approx(interval_s).epsilon(1e-9));

  std::vector<double> rounded(even);
  const double digit_s = 0.4 * interval_s;
  for (double& t : rounded) t = std::round(t / digit_s) * digit_s;
  CHECK(interval_of(rounded) == Approx(interval_s).epsilon(1e-3));
}

TEST_CASE("stamps that are rounded to several rows are spread evenly again") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  const int rows = std::uniform_int_distribution<int>(3, 12)(generator);
  const double interval_s = 1e-3, digit_s = rows * interval_s;
  std::vector<double> stamps;
  for (const double t : even_times(1200, interval_s)) stamps.push_back(std::floor(t / digit_s + 1e-9) * digit_s);
  REQUIRE(spread_rounded(stamps));
  CHECK(interval_of(stamps) == Approx(interval_s).epsilon(1e-3));
  for (std::size_t i = 1; i < stamps.size(); ++i) REQUIRE(stamps[i] > stamps[i - 1]);
  std::vector<double> plain = even_times(100, interval_s);
  CHECK_FALSE(spread_rounded(plain));
}

TEST_CASE("a run begins where the time goes back and stays back, not at a row out of order or a spike") {
  const std::vector<double> first = even_times(50, 1e-3);
  std::vector<double> two(first);
  two.insert(two.end(), first.begin(), first.end());
  CHECK(run_starts(two) == std::vector<std::size_t>{0, 50});
  std::vector<double> swapped(first);
  std::swap(swapped[20], swapped[21]);
  CHECK(run_starts(swapped) == std::vector<std::size_t>{0});
  std::vector<double> spike(first);
  spike[30] = 99;
  CHECK(run_starts(spike) == std::vector<std::size_t>{0});
  std::vector<double> set_back(first);
  for (std::size_t i = 25; i < set_back.size(); ++i) set_back[i] -= 0.02;  // a clock that was set
  CHECK(run_starts(set_back) == std::vector<std::size_t>{0, 25});
}

TEST_CASE("times of day go on behind midnight, as a clock's text and as seconds of the day") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  const double interval_s = 1e-3 * std::uniform_int_distribution<int>(1, 20)(generator);
  const double start_s = 86400 - 50 * interval_s - std::uniform_real_distribution<double>(0, interval_s)(generator);
  const TemporaryFolder folder;
  for (const bool is_clock : {true, false}) {
    std::string text = "t_s,x_m\n";
    for (int i = 0; i < 120; ++i) {
      const double day_s = std::fmod(start_s + i * interval_s, 86400);
      const int whole = static_cast<int>(day_s);
      text += is_clock ? fmt::format("{:02d}:{:02d}:{:09.6f},{}\n", whole / 3600, whole / 60 % 60,
                                     day_s - 60 * (whole / 60), i)
                       : fmt::format("{:.6f},{}\n", day_s, i);
    }
    CAPTURE(is_clock, text.substr(text.size() / 2 - 60, 120));
    const std::vector<Recording> runs = read_recordings(put_plain(folder.file("night.csv"), text), std::nullopt, 1e-3);
    REQUIRE(runs.size() == 1);
    REQUIRE(runs[0].rows() == 120);
    for (std::size_t i = 0; i < 120; ++i)
      REQUIRE(runs[0].t_s()[i] - runs[0].t_s()[0] == Approx(static_cast<double>(i) * interval_s).margin(2e-6));
    CHECK_THAT(fmt::format("{}", fmt::join(problem_lines(runs[0]), "\n")), Contains("midnight"));
  }
  // A second run that begins at 0 is one, and no day.
  std::vector<double> two = even_times(50, 1e-3);
  two.insert(two.end(), two.begin(), two.begin() + 40);
  CHECK(pass_midnights(two, false) == 0);
}

TEST_CASE("a counter of 16 or 32 bits goes on behind its end, runs that begin at 0 anew do not") {
  const TemporaryFolder folder;
  struct Counter {
    const char* name;
    double start, step, turn;
  };
  for (const Counter& counter : {Counter{"micros", 4294600000.0, 1000, 4294967296.0},
                                 Counter{"millis", 4294966000.0, 2, 4294967296.0}, Counter{"ms", 65000, 1, 65536.0}}) {
    std::string text = fmt::format("{},x_m,u_V\n", counter.name);
    for (int i = 0; i < 2000; ++i)
      text += fmt::format("{:.0f},{},0\n", std::fmod(counter.start + i * counter.step, counter.turn), 1e-4 * i);
    put_plain(folder.file("counter.csv"), text);
    ImportParameters map;
    map.columns["t_s"].column = counter.name;
    map.columns["x_m"].column = "x_m";
    const std::vector<Recording> runs = read_recordings(folder.file("counter.csv"), map, 1e-3);
    CAPTURE(counter.name);
    REQUIRE(runs.size() == 1);
    CHECK(runs[0].rows() == 2000);
    CHECK(runs[0].period_s == Approx(counter.name == std::string("millis") ? 2e-3 : 1e-3));
    CHECK_THAT(fmt::format("{}", fmt::join(problem_lines(runs[0]), "\n")), Contains("begins again"));
  }
  std::vector<double> two = even_times(65536, 1e-3);
  two.insert(two.end(), two.begin(), two.begin() + 40);
  two.erase(two.begin() + 65000, two.begin() + 65536);  // another run, which began at 0 as well
  CHECK(pass_wraps(two) == 0);
}

TEST_CASE("two runs in one file are two recordings with or without a map, and that is told") {
  const TemporaryFolder folder;
  std::string text = "t_s,x_m,u_V\n";
  for (int run = 0; run < 2; ++run)
    for (int i = 0; i < 100; ++i) text += fmt::format("{},{},{}\n", i * 0.002, 0.001 * i + run, run);
  put_plain(folder.file("two.csv"), text);
  ImportParameters map;
  map.columns["x_m"].column = "x_m";
  for (const auto& imported : {std::optional<ImportParameters>(), std::optional(map)}) {
    const std::vector<Recording> runs = read_recordings(folder.file("two.csv"), imported, 1e-3);
    REQUIRE(runs.size() == 2);
    CHECK(runs[0].rows() == 100);
    CHECK(runs[1].column("x_m").front() == 1);
    CHECK(runs[1].period_s == Approx(0.002));
    CHECK_THAT(fmt::format("{}", fmt::join(problem_lines(runs[0]), "\n")), Contains("recording of their own"));
  }
}

TEST_CASE("what a map names and the file has under a near name is asked for, an unknown name of ours refused") {
  const TemporaryFolder folder;
  put_plain(folder.file("m.csv"), "Zeit_s,Weg_mm,Ventil_V\n0,1,2\n0.001,2,3\n");
  ImportParameters map;
  map.columns["t_s"].column = "Zeit_s";
  map.columns["x_m"].column = "Weg";
  const Recording run = read_recordings(folder.file("m.csv"), map, 1e-3).at(0);
  CHECK_THAT(run.problems.at(0).sentence,
             Contains("Weg is missing") && Contains("did you mean Weg_mm") && Contains("Ventil_V"));
  map.columns["x"] = map.columns["x_m"];
  CHECK_THROWS_WITH(read_recordings(folder.file("m.csv"), map, 1e-3), Contains("found x") && Contains("x_m"));
}
