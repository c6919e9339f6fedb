// Doubts of ranges and steps: turns of a counter, clipped ends, coarse sensors, copies; right channels are left alone.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include "config/input_error.hpp"
#include "core/test_seed.hpp"
#include "diagnosis/doubts/range_doubts.hpp"
#include "diagnosis/doubts/recording_doubts.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

const std::vector<std::string> ports{"p1_port_Pa", "p2_port_Pa"};

struct Drawn {
  unsigned seed = test::new_seed();
  std::mt19937 generator{seed};
  double between(double least, double most) { return std::uniform_real_distribution<double>(least, most)(generator); }
};

/// Sines with a rest, 1 ms apart, with white noise; one column.
Recording motion(Drawn& drawn, double amplitude_m, double noise_m) {
  std::normal_distribution<double> noise(0, noise_m);
  Recording out;
  out.path = "motion";
  out.period_s = 1e-3;
  out.names = {"t_s", "x_m"};
  out.values.resize(2);
  const double rate = drawn.between(2, 6);
  for (int i = 0; i < 6000; ++i) {
    const double moved_s = 1e-3 * std::min(i, 4500);
    const double course = std::sin(rate * moved_s) + 0.2 * std::sin(2.3 * rate * moved_s);
    out.values[0].push_back(1e-3 * i);
    out.values[1].push_back(amplitude_m * course + noise(drawn.generator));
    out.line_numbers.push_back(static_cast<std::size_t>(i));
  }
  return out;
}

double largest_range_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace

TEST_CASE("the turns of a counter are added, whatever its range and where it begins") {
  Drawn drawn;
  INFO("seed " << drawn.seed << " (PNEUSERVO_TEST_SEED)");
  Rig rig = test::cylinder_rig();
  rig.sensors.position.noise_m = 2e-6;
  const Recording right = motion(drawn, 0.1, 2e-6);
  for (const double share : {0.4, 0.55, 0.8}) {
    Recording wrong = right;
    const double range_m = std::round(share * 0.2 / 5e-6) * 5e-6, begin_m = drawn.between(-0.1, -0.06);
    for (double& x : wrong.column("x_m")) x -= range_m * std::floor((x - begin_m) / range_m);
    std::vector<std::string> notes;
    CAPTURE(share, range_m, begin_m);
    unwrap_position(rig, wrong, notes);
    REQUIRE(notes.size() == 1);
    CHECK_THAT(notes[0], Contains("x_m begins again"));
    // Its zero is one of the counter's: whole ranges from the true one.
    const double shift = std::round((wrong.column("x_m")[0] - right.column("x_m")[0]) / range_m) * range_m;
    std::vector<double> shifted = right.column("x_m");
    for (double& x : shifted) x += shift;
    // Noise of a step leaves the counter's range unsure by a quantum, once for each turn.
    const double most_turns = std::ceil(0.2 / range_m);
    CHECK(largest_range_difference(wrong.column("x_m"), shifted) < 5e-6 * most_turns + 1e-9);
  }
}

TEST_CASE("spikes, an encoder that freezes, gaps and steps are no turns of a counter") {
  Drawn drawn;
  INFO("seed " << drawn.seed << " (PNEUSERVO_TEST_SEED)");
  const Rig rig = test::cylinder_rig();
  const Recording right = motion(drawn, 0.1, 2e-6);
  const auto left_alone = [&](auto change) {
    Recording wrong = right;
    change(wrong);
    const std::vector<double> before = wrong.column("x_m");
    std::vector<std::string> notes;
    unwrap_position(rig, wrong, notes);
    CAPTURE(notes);
    CHECK(notes.empty());
    CHECK(wrong.column("x_m") == before);
  };
  const std::size_t at = 500 + drawn.generator() % 3000;
  left_alone([](Recording&) {});
  left_alone([&](Recording& r) { r.column("x_m")[at] += 0.19; });
  left_alone([&](Recording& r) {
    std::vector<double>& x = r.column("x_m");
    std::fill(x.begin() + static_cast<std::ptrdiff_t>(at), x.begin() + static_cast<std::ptrdiff_t>(at) + 700, x[at]);
  });
  left_alone([&](Recording& r) {
    for (auto& values : r.values)
      values.erase(values.begin() + static_cast<std::ptrdiff_t>(at),
                   values.begin() + static_cast<std::ptrdiff_t>(at) + 600);
  });
  left_alone([](Recording& r) {
    for (std::size_t i = 0; i < r.column("x_m").size(); ++i) r.column("x_m")[i] = i / 500 % 2 == 0 ? 0.1 : -0.1;
  });
}

TEST_CASE("an end of the range where values pile up is clipped, with noise and without, a rest at the end is not") {
  Drawn drawn;
  INFO("seed " << drawn.seed << " (PNEUSERVO_TEST_SEED)");
  for (const double noise_m : {0.0, 1e-5}) {
    const Recording right = motion(drawn, 0.1, noise_m);
    const std::vector<double>& x = right.column("x_m");
    const int frozen_rows = noise_m > 0 ? 20 : 0;
    CHECK(clipped_ends(x, 6 * noise_m, frozen_rows).empty());
    const double end = drawn.between(0.3, 0.8) * *std::max_element(x.begin(), x.end());
    std::vector<double> high(x), low(x);
    std::size_t beyond = 0;
    for (double& value : high) beyond += value >= end, value = std::min(value, end);
    for (double& value : low) value = std::max(value, -end);
    const auto seen = clipped_ends(high, 6 * noise_m, frozen_rows);
    CAPTURE(noise_m, end);
    REQUIRE(seen.size() == 1);
    CHECK(seen[0].value == end);
    CHECK(seen[0].rows == beyond);
    REQUIRE(clipped_ends(low, 6 * noise_m, frozen_rows).size() == 1);
    CHECK(clipped_ends(low, 6 * noise_m, frozen_rows)[0].value == -end);
  }
  // A coarse encoder that comes to rest at its furthest place, again and again.
  std::vector<double> rests;
  for (int i = 0; i < 6000; ++i) {
    const double lap = i % 1500;
    rests.push_back(std::round(1000 * 0.1 *
                               (lap < 1000   ? 0.5 - 0.5 * std::cos(2e-3 * M_PI * lap)
                                : lap < 1250 ? 0
                                             : 0)) /
                    1000);
  }
  CHECK(clipped_ends(rests, 1e-3, 0).empty());
}

TEST_CASE("clipped pressures are left out and told, and nothing else of the recording") {
  Drawn drawn;
  INFO("seed " << drawn.seed << " (PNEUSERVO_TEST_SEED)");
  Rig rig = test::cylinder_rig();
  std::vector<Recording> wrong{test::simulated_recording(rig, 5.0, drawn.seed, ports)};
  std::vector<double>& p1 = wrong[0].column("p1_port_Pa");
  const std::vector<double> p1_before = p1;
  std::vector<double> sorted(p1);
  std::sort(sorted.begin(), sorted.end());
  const double end_Pa = sorted[sorted.size() * 85 / 100];
  for (double& p : p1) p = std::min(p, end_Pa);
  std::vector<std::string> notes;
  doubt_recordings(rig, wrong, notes);
  CAPTURE(notes);
  REQUIRE(notes.size() == 1);
  CHECK_THAT(notes[0], Contains("p1_port_Pa is clipped at"));
  const std::vector<double>& left = wrong[0].column("p1_port_Pa");
  std::size_t below = 0, kept = 0;
  for (std::size_t i = 0; i < p1_before.size(); ++i) {
    below += p1_before[i] < end_Pa;
    kept += std::isfinite(left[i]) && left[i] == p1_before[i];
    CHECK_FALSE(left[i] >= end_Pa);
  }
  CHECK(kept == below);
  CHECK(std::isfinite(wrong[0].column("p2_port_Pa")[2000]));
}

TEST_CASE("a sensor that is coarser than its section becomes so in the rig, and is told, one that is not stays") {
  Drawn drawn;
  INFO("seed " << drawn.seed << " (PNEUSERVO_TEST_SEED)");
  Rig rig = test::cylinder_rig();
  const Recording right = test::simulated_recording(rig, 5.0, drawn.seed, ports);
  std::vector<std::string> notes;
  take_resolution(rig, right, notes);
  CHECK(notes.empty());
  Recording coarse = right;
  const double step_Pa = drawn.between(2000, 6000), step_m = drawn.between(1e-4, 5e-4);
  for (const auto& name : ports)
    for (double& p : coarse.column(name)) p = std::round(p / step_Pa) * step_Pa;
  for (double& x : coarse.column("x_m")) x = std::round(x / step_m) * step_m;
  take_resolution(rig, coarse, notes);
  CAPTURE(notes);
  REQUIRE(notes.size() == 2);
  CHECK_THAT(notes[0], Contains("sensors.port_pressure.quantum_Pa"));
  CHECK(rig.sensors.port_pressure.quantum_Pa == Approx(step_Pa));
  CHECK(rig.sensors.position.quantum_m == Approx(step_m));
  std::vector<Recording> doubted{coarse};
  notes.clear();
  doubt_recordings(rig, doubted, notes);  // equal values of so coarse a sensor are not frozen
  CAPTURE(notes);
  CHECK(notes.empty());
}

TEST_CASE("a copy is told as one, scaled or not, two sensors of one pressure are not") {
  Drawn drawn;
  INFO("seed " << drawn.seed << " (PNEUSERVO_TEST_SEED)");
  const Rig rig = test::cylinder_rig();
  const Recording right = test::simulated_recording(rig, 4.0, drawn.seed, test::all_pressures);
  CHECK_NOTHROW(refuse_repeated_channels(rig, right));
  for (const double factor : {1.0, drawn.between(0.2, 3)}) {
    Recording wrong = right;
    for (std::size_t i = 0; i < wrong.rows(); ++i)
      wrong.column("p2_port_Pa")[i] = factor * wrong.column("p1_port_Pa")[i] + (factor == 1 ? 0 : 5e4);
    CHECK_THROWS_WITH(refuse_repeated_channels(rig, wrong), Contains("p2_port_Pa repeats p1_port_Pa"));
  }
  Recording twice = right;  // one pressure, two sensors
  std::normal_distribution<double> noise(0, rig.sensors.port_pressure.noise_Pa);
  for (std::size_t i = 0; i < twice.rows(); ++i)
    twice.column("p2_port_Pa")[i] = twice.column("p1_port_Pa")[i] + noise(drawn.generator);
  CHECK_NOTHROW(refuse_repeated_channels(rig, twice));
}
