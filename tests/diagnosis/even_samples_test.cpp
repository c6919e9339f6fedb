// Columns on an even grid by their stamps: jitter, losses, sparse columns, gaps; and recordings cut at gaps.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include "config/input_error.hpp"
#include "core/test_seed.hpp"
#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/recordings/even_samples.hpp"
#include "diagnosis/recordings/noise_level.hpp"
#include "diagnosis/recordings/stretches.hpp"
#include "diagnosis/residuals/imposed_run.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

double course(double t) { return 0.08 * std::sin(6.3 * t) + 0.01 * std::sin(40 * t); }

std::vector<double> courses(const std::vector<double>& times) {
  std::vector<double> out;
  for (const double t : times) out.push_back(course(t));
  return out;
}

double largest_error(const std::vector<double>& drawn, double interval_s) {
  double largest = 0;
  for (std::size_t k = 0; k < drawn.size(); ++k)
    if (std::isfinite(drawn[k]))
      largest = std::max(largest, std::abs(drawn[k] - course(interval_s * static_cast<double>(k))));
  return largest;
}

/// Rows of a recording for which keep(i) holds.
template <class Keep> Recording rows_of(const Recording& recording, const Keep& keep) {
  Recording out = recording;
  for (auto& values : out.values) values.clear();
  out.line_numbers.clear();
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    if (!keep(i)) continue;
    for (std::size_t c = 0; c < out.values.size(); ++c) out.values[c].push_back(recording.values[c][i]);
    out.line_numbers.push_back(i);
  }
  return out;
}

}  // namespace

TEST_CASE("a jittered course is drawn at its even samples to the cubic's error") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double interval_s = 2e-3;
  std::vector<double> times;
  for (int i = 0; i < 1500; ++i) times.push_back(i * interval_s + (i > 0 ? 0.4e-3 * uniform(generator) : 0));
  const EvenSamples even(times, interval_s);
  const std::vector<double> drawn = even.drawn(courses(times));
  // At both ends, without a fourth row, a line is off by an eighth of the second derivative, 19 m/s2, times h^2.
  CHECK(largest_error(drawn, interval_s) < 1.2 * 19.2 / 8 * interval_s * interval_s * 1.4);
  double inner = 0;  // within, a row a thousandth off its place at 0.9 m/s, and the cubic's own error
  for (std::size_t k = 2; k + 3 < drawn.size(); ++k)
    inner = std::max(inner, std::abs(drawn[k] - course(interval_s * static_cast<double>(k))));
  CHECK(inner < 2e-6);
  CHECK(std::count_if(drawn.begin(), drawn.end(), [](double v) { return std::isfinite(v); }) >= 1498);
}

TEST_CASE("lost rows are drawn, a sparse column at its own rate, nothing through a gap") {
  const double interval_s = 1e-3;
  std::vector<double> times;
  for (int i = 0; i < 2000; ++i)
    if (i % 97 != 5 && (i < 1000 || i > 1300)) times.push_back(i * interval_s);
  const EvenSamples even(times, interval_s);
  const std::vector<double> drawn = even.drawn(courses(times));
  CHECK(largest_error(drawn, interval_s) < 1e-8);
  CHECK(std::isfinite(drawn[102]));
  CHECK(std::isnan(drawn[1150]));
  std::vector<double> sparse = courses(times);
  for (std::size_t i = 0; i < sparse.size(); ++i)
    if (i % 5 != 0) sparse[i] = std::nan("");
  CHECK(largest_error(even.drawn(sparse), interval_s) < 1e-4);  // straight beside the gap
  CHECK(std::isnan(even.placed(sparse)[1]));
  CHECK(drawing_error(times, courses(times), interval_s) < 1e-8);
}

TEST_CASE("stamps that are rounded alone stand at their samples, stamps that jitter beyond their digits do not") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  for (const double interval_s : {2.5e-3, 1.0 / 60, 3.3e-3}) {
    std::vector<double> exact, rounded, cut, jittered;
    for (int i = 0; i < 1200; ++i) {
      exact.push_back(i * interval_s);
      rounded.push_back(std::round(exact.back() * 1e3) * 1e-3);
      cut.push_back(std::floor(exact.back() * 1e3 + 1e-6) * 1e-3);
      jittered.push_back(std::round((exact.back() + 2e-4 * normal(generator)) * 1e6) * 1e-6);
    }
    CAPTURE(interval_s);
    for (const std::vector<double>& times : {rounded, cut}) {
      const EvenSamples even(times, interval_s);
      CHECK(even.is_even());
      CHECK(largest_error(even.drawn(courses(exact)), interval_s) < 1e-12);
    }
    CHECK_FALSE(EvenSamples(jittered, interval_s).is_even());
  }
}

TEST_CASE("a command that somebody read beside the loop is imposed without delay, one of its own instant too") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  const Rig rig = test::cylinder_rig(2.0);
  const Recording whole = test::simulated_recording(rig, 6.0, 3, test::all_pressures);
  const std::vector<double>& u = whole.column("u_V");
  const double loop_s = 1e-3;
  for (const int every : {1, 2, 4})
    for (const bool is_held : {true, false}) {
      if (!is_held && every > 2) continue;  // rows further apart do not tell, beside a noisy loop
      Recording polled =
          rows_of(whole, [&](std::size_t i) { return i > 0 && i % static_cast<std::size_t>(every) == 0; });
      for (std::size_t i = 0; i < polled.rows(); ++i) {
        double& t = polled.column("t_s")[i];
        t += (i > 0 ? std::clamp(0.2 * normal(generator), -0.4, 0.4) : 0.0) * loop_s;
        const double tick = std::floor(t / loop_s + 1e-9), since = is_held ? 0 : t / loop_s - tick;
        const auto at = static_cast<std::size_t>(tick);
        polled.column("u_V")[i] = u[at] + since * (u[std::min(at + 1, u.size() - 1)] - u[at]);
      }
      polled.period_s = every * loop_s;
      const CylinderRecording prepared = prepare_recording(polled, rig, 1e300);
      double both = 0, square = 0;
      for (std::size_t k = 100; k + 100 < prepared.samples(); ++k)
        for (int step = 0; step < every; ++step) {
          const auto at = static_cast<std::size_t>(every) * (k + 1) + static_cast<std::size_t>(step);
          const double rate = (u[at + 3] - u[at - 3]) / (6 * loop_s);
          both -= (prepared.inputs.command_at(0, k, step) - u[at]) * rate;
          square += rate * rate;
        }
      CAPTURE(every, is_held);
      CHECK(std::abs(both / square) < 0.15 * loop_s);
    }
}

TEST_CASE("the noise of a channel is told beside its motion at every rate") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  for (const double period_s : {1e-3, 2e-3, 4e-3, 0.01}) {
    std::vector<double> always, resting;  // moving throughout; moving with rests and ringing of what no rate here shows
    for (double t = 0; t < 16; t += period_s) {
      const bool rests = std::fmod(t, 1.6) > 1.0;
      always.push_back(3e4 * std::sin(2 * 3.14159265 * 1.5 * t) + 300 * normal(generator));
      resting.push_back((rests ? 0 : 8e3 * std::sin(2 * 3.14159265 * 47.3 * t)) + 300 * normal(generator));
    }
    CAPTURE(period_s);
    for (const double noise : {quiet_noise(always, period_s), quiet_noise(resting, period_s)}) {
      CHECK(noise < 1.2 * 300);
      CHECK(noise > 0.5 * 300);  // the least of windows of 40 rows is low by a third
    }
  }
}

TEST_CASE("the usual noise of a command is that of its motion where it is still at rest") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  for (const double period_s : {1e-3, 4e-3, 0.01}) {
    std::vector<double> command_V;  // a coarse encoder: noise in three quarters of the time, steps, and none at rest
    for (double t = 0; t < 32; t += period_s) {
      const bool rests = std::fmod(t, 6.4) > 4.8;
      const double motion_V = 2 * std::sin(2 * 3.14159265 * 1.5 * t) + (std::fmod(t, 8.0) > 4.0 ? 1.0 : 0.0);
      command_V.push_back(rests ? 0.5 : motion_V + 0.05 * normal(generator));
    }
    CAPTURE(period_s);
    CHECK(quiet_noise(command_V, period_s) < 0.001);
    CHECK(usual_noise(command_V, period_s) == Approx(0.05).epsilon(0.3));
  }
}

TEST_CASE("a recording is cut at a gap, short ends are left out, and all of it is told") {
  const Rig rig = test::cylinder_rig();
  Recording whole = test::simulated_recording(rig, 8.0, 3, test::all_pressures);
  std::vector<std::string> notes;
  CHECK(compared_stretches(rig, {whole}, notes).size() == 1);
  CHECK(notes.empty());
  const Recording lossy = rows_of(whole, [](std::size_t i) { return i % 31 != 0; });
  CHECK(compared_stretches(rig, {lossy}, notes).size() == 1);
  CHECK(notes.empty());
  const Recording gaps =
      rows_of(whole, [](std::size_t i) { return !(i > 3000 && i < 3300) && !(i > 7000 && i < 7200); });
  const std::vector<Recording> parts = compared_stretches(rig, {gaps}, notes);
  REQUIRE(parts.size() == 2);
  CHECK(parts[1].t_s().front() == Approx(3.3));
  CHECK(parts[1].t_s().back() == Approx(7.0));
  REQUIRE(notes.size() == 2);
  CHECK_THAT(notes[0], Contains("3 to 3.3 s") && Contains("7 to 7.2 s"));
  CHECK_THAT(notes[1], Contains("left out"));
  // A position that is missing while rows go on is a gap too.
  for (std::size_t i = 2000; i < 2500; ++i) whole.column("x_m")[i] = std::nan("");
  notes.clear();
  CHECK(compared_stretches(rig, {whole}, notes).size() == 2);
  const Recording short_one = rows_of(whole, [](std::size_t i) { return i % 1000 < 900; });
  CHECK_THROWS_WITH(compared_stretches(rig, {short_one}, notes), Contains("0.9 s") || Contains("0.899 s"));
}

TEST_CASE("a run at every n-th row simulates what the run at all rows does") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  const Rig rig = test::cylinder_rig(2.0);
  const double frequency = std::uniform_real_distribution<double>(1, 3)(generator);
  const auto inputs_at = [&](int every) {
    ImposedInputs inputs;
    inputs.period_s = 1e-3 * every;
    inputs.steps = every;
    inputs.command_is_held = every == 1;
    inputs.release = static_cast<std::size_t>(300 / every);
    for (int i = 0; i < 3000; i += every) {
      const double phase =
          2 * 3.14159265 * frequency * 1e-3 * std::max(0, i - 400);  // at rest while ports are followed
      inputs.command_V[0].push_back(0.4 * std::sin(phase));
      inputs.position_m.push_back(-0.05 * std::cos(phase));
      inputs.velocity_mps.push_back(i < 400 ? 0 : 0.05 * 2 * 3.14159265 * frequency * std::sin(phase));
      for (std::size_t side = 0; side < 2; ++side) {
        inputs.start_Pa[side].push_back(5e5);
        inputs.start_Pa_per_s[side].push_back(0);
      }
    }
    return inputs;
  };
  const ImposedRun run{&rig, {}};
  const ImposedInputs all = inputs_at(1);
  const GasCourse whole = run_imposed(all, std::span(&run, 1), grid_for(rig, 100, all.step_s()))[0];
  for (const int every : {2, 4, 10}) {
    const ImposedInputs thinned = inputs_at(every);
    const GasCourse course = run_imposed(thinned, std::span(&run, 1), grid_for(rig, 100, thinned.step_s()))[0];
    double largest = 0;
    for (std::size_t k = 0; k < course[Signal::p1_port].size(); ++k)
      largest = std::max(
          largest, std::abs(course[Signal::p1_port][k] - whole[Signal::p1_port][k * static_cast<std::size_t>(every)]));
    CAPTURE(every);
    CHECK(largest < 300);  // of a swing of 100 kPa
  }
}
