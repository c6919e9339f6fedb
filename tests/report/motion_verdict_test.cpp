// What a run is said to have done: known lags, swings, blows and drawn loops get the words that are true.
#include <catch2/catch.hpp>

#include <array>
#include <complex>

#include <pneuservo/core/random.hpp>

#include "backends.hpp"
#include "config/read_rig.hpp"
#include "core/test_seed.hpp"
#include "design/axis_design.hpp"
#include "loop/runner.hpp"
#include <report/evaluation.hpp>
#include <report/motion_verdict.hpp>

#include "synthetic_rows.hpp"

using namespace pneuservo;
using test::make_rows;
using test::wave;

namespace {

constexpr double amplitude_m = 0.08, reference_Hz = 1.0;

Rig judged_sine_rig() {
  Rig rig;
  rig.reference.kind = ReferenceKind::sine;
  rig.reference.amplitude_m = amplitude_m;
  rig.reference.frequency_Hz = reference_Hz;
  rig.duration_s = 6.0;
  rig.axis.cylinder.stroke_m = 0.3;
  rig.axis.valve.command_max_V = 5.0;
  rig.sensors.position.quantum_m = 5e-6;
  return rig;
}

RunResult judged(const Rig& rig, std::vector<Row> rows) {
  RunResult run;
  run.rows = std::move(rows);
  run.metrics = evaluate(rig, run.rows);
  run.verdict = judge_motion(rig, run);
  return run;
}

/// An axis that comes `lag_s` late with `ratio` of the amplitude; `more(row)` adds to it.
template <class More> RunResult lagging(double lag_s, double ratio, More&& more) {
  return judged(judged_sine_rig(), make_rows(6.0, 1e-3, [&](Row& row) {
                  row.x_ref_m = amplitude_m * wave(reference_Hz, row.t_s);
                  row.x_true_m = row.measured[Signal::x] = ratio * amplitude_m * wave(reference_Hz, row.t_s - lag_s);
                  row.u_V = 1.2 * wave(reference_Hz, row.t_s + 0.2);
                  more(row);
                }));
}
RunResult lagging(double lag_s, double ratio) {
  return lagging(lag_s, ratio, [](Row&) {});
}

/// The simulated axis with nothing that would end its run.
RunResult simulated(Rig rig) {
  rig.limits.deviation_m = rig.limits.speed_deviation_mps = rig.limits.stall_force_N = 0.0;
  rig.limits.flow_mismatch_share = 0.0;
  rig.limits.speed_mps = 100.0;
  rig.limits.end_stop_contact = EndStopContact::allowed;
  const auto backend = make_backend("sim", rig);
  backend->configure();
  RunOutcome outcome = run_loop(rig, *backend, {});
  RunResult run;
  run.faults = outcome.faults;
  run.start_s = outcome.moves.at(0).start_s;
  run.rows = std::move(outcome.rows);
  run.metrics = evaluate(rig, run.rows, run.start_s);
  run.verdict = judge_motion(rig, run);
  return run;
}

std::string said(const RunResult& run) {
  return std::string(verdict_word(run.verdict)) + ": " + following_words(run.verdict) + ", " +
         share_words(run.verdict) + trouble_words(run.verdict);
}

}  // namespace

TEST_CASE("the share of the amplitude decides between following, lagging and not following") {
  Random random(test::new_seed());
  for (int i = 0; i < 20; ++i) {
    const double lag_s = random.uniform(0.0, 0.2), ratio = random.uniform(0.4, 1.1);
    const RunResult run = lagging(lag_s, ratio);
    const double share = std::abs(1.0 - std::polar(ratio, -2.0 * std::numbers::pi * reference_Hz * lag_s));
    INFO("seed " << test::stated_seed().value_or(0) << ": " << lag_s << " s, " << ratio << ": " << said(run));
    CHECK(run.verdict.error_share == Approx(share).epsilon(2e-3).margin(1e-4));
    CHECK(run.verdict.lag_s == Approx(lag_s).margin(1.1e-3));
    CHECK(run.verdict.amplitude_ratio == Approx(ratio).epsilon(0.01));
    const bool not_near = std::fabs(share - follows_share) > 1e-3 && std::fabs(share - lags_share) > 1e-3;
    if (!not_near) continue;
    CHECK((run.verdict.following == Following::follows) == (share < follows_share));
    CHECK((run.verdict.following == Following::does_not_follow) == (share > lags_share));
    CHECK_FALSE(run.verdict.oscillates);
    CHECK_FALSE(run.verdict.touched_end_stop);
  }
}

TEST_CASE("what swings beside the reference is told with its frequency and amplitudes") {
  Random random(test::new_seed());
  for (int i = 0; i < 20; ++i) {
    // Whole and half multiples of the reference's frequency are its own harmonics.
    const double f = std::floor(random.uniform(1.0, 60.0)) + random.uniform(0.3, 0.7);
    const double swing_m = random.uniform(0.3e-3, 20e-3), swing_V = random.uniform(0.1, 3.0);
    const RunResult run = lagging(0.02, 1.0, [&](Row& row) {
      row.x_true_m += swing_m * wave(f, row.t_s);
      row.u_V += swing_V * wave(f, row.t_s + 0.3 / f);
    });
    INFO(f << " Hz, " << swing_m << " m, " << swing_V << " V: " << said(run));
    CHECK(run.verdict.oscillates);
    CHECK(run.verdict.oscillation_Hz == Approx(f).margin(0.1));
    CHECK(run.verdict.oscillation_m == Approx(swing_m).epsilon(0.25));
    CHECK(run.verdict.oscillation_V == Approx(swing_V).epsilon(0.25));
    CHECK_FALSE(run.verdict.oscillation_grows);
  }
}

TEST_CASE("a swing that comes where the axis is slow and goes where it is fast is one") {
  Random random(test::new_seed());
  for (int i = 0; i < 10; ++i) {
    const double f = std::floor(random.uniform(12.0, 50.0)) + random.uniform(0.3, 0.7);
    const double swing_V = random.uniform(0.5, 3.0);
    const RunResult run = lagging(0.02, 1.0, [&](Row& row) {  // as long as the flow does not damp the line
      const double burst = std::max(0.0, std::fabs(wave(reference_Hz, row.t_s)) - 0.5);
      row.x_true_m += 1e-3 * burst * wave(f, row.t_s);
      row.u_V += swing_V * burst * wave(f, row.t_s + 0.2 / f);
    });
    INFO(f << " Hz, " << swing_V << " V: " << said(run));
    CHECK(run.verdict.oscillates);
    CHECK_FALSE(run.verdict.oscillation_grows);
  }
}

TEST_CASE("a swing that grows is told, one that dies and harmonics of the reference are none") {
  const auto swinging = [](double per_s) {
    return lagging(0.02, 1.0, [&](Row& row) {
      const double size = std::exp(per_s * (row.t_s - 4.5));
      row.x_true_m += 2e-3 * size * wave(9.4, row.t_s);
      row.u_V += 0.4 * size * wave(9.4, row.t_s + 0.02);
    });
  };
  CHECK(swinging(1.0).verdict.oscillation_grows);
  CHECK_FALSE(swinging(-3.0).verdict.oscillates);
  const RunResult rich = lagging(0.02, 1.0, [](Row& row) {  // dry friction, valve edges: odd harmonics
    row.x_true_m += 2e-3 * wave(3.0 * reference_Hz, row.t_s) + 1e-3 * wave(5.0 * reference_Hz, row.t_s);
    row.u_V += 0.4 * wave(3.0 * reference_Hz, row.t_s);
  });
  INFO(said(rich));
  CHECK_FALSE(rich.verdict.oscillates);
}

TEST_CASE("noise is no swing") {
  Random random(test::new_seed());
  const RunResult run = lagging(0.02, 1.0, [&](Row& row) {
    row.x_true_m += 2e-4 * random.normal();
    row.u_V += 0.15 * random.normal();
  });
  INFO(said(run));
  CHECK_FALSE(run.verdict.oscillates);
}

TEST_CASE("a blow at the end stop is told with place, time and speed, a start at it is not") {
  const Rig rig = judged_sine_rig();
  const auto bouncing = [&](double from_m, double speed_mps) {
    return judged(rig, make_rows(6.0, 1e-3, [&](Row& row) {
                    row.x_ref_m = 0.01 * wave(1.0, row.t_s);
                    const double hit_s = (0.15 - from_m) / speed_mps;
                    row.x_true_m = row.measured[Signal::x] =
                        row.t_s < hit_s ? from_m + speed_mps * row.t_s
                                        : 0.15 - 0.3 * speed_mps * std::min(0.05, row.t_s - hit_s);
                  }));
  };
  const MotionVerdict hit = bouncing(-0.1, 0.7153).verdict;
  REQUIRE(hit.touched_end_stop);
  CHECK(hit.end_stop_m == 0.15);
  CHECK(hit.end_stop_s == Approx(0.25 / 0.7153).margin(2e-3));
  CHECK(hit.end_stop_speed_mps == Approx(0.7153).epsilon(1e-3));
  CHECK(verdict_word(hit) == "end_stop");
  const MotionVerdict leaves = judged(rig, make_rows(6.0, 1e-3,
                                                     [](Row& row) {
                                                       row.x_ref_m = 0.1;
                                                       row.x_true_m = row.measured[Signal::x] =
                                                           -0.15 + std::min(0.25, 0.1 * row.t_s);
                                                     }))
                                   .verdict;
  CHECK_FALSE(leaves.touched_end_stop);
}

TEST_CASE("drawn gains above what the linear loop bears swing at rest, gains well below do not") {
  const unsigned seed = test::new_seed();
  Random random(seed);
  const std::array<const char*, 4> lines{"10m-7.65mm", "10m-6.10mm", "2m-7.65mm", "5m-6.10mm"};
  for (int i = 0; i < 6; ++i) {
    const char* line = lines[static_cast<std::size_t>(random.uniform(0.0, 4.0))];
    Rig rig = read_rig(
        std::string(PNEUSERVO_SOURCE_DIR) + "/config/cylinder-" + line + ".yaml",
        {"reference={kind: sine, amplitude_m: 0, frequency_Hz: 1}", "duration_s=6", "initial.position_m=0.0004"});
    const double limit = loop_point(rig, true).margins.gain_up;
    const bool high = i % 2 == 0;
    const double factor = high ? random.uniform(1.6, 8.0) * limit : random.uniform(0.3, 0.55) * limit;
    rig.controller.of<PdForce>().force_gain_V_per_N *= factor;
    const RunResult run = simulated(rig);
    INFO("seed " << seed << ", " << line << ", gain times " << factor << ", limit " << limit << ": " << said(run));
    CHECK(run.verdict.oscillates == high);
  }
}

TEST_CASE("a payload that takes the damping away swings and does not follow") {
  const unsigned seed = test::new_seed();
  Random random(seed);
  for (int i = 0; i < 3; ++i) {
    Rig rig = read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-10m-7.65mm.yaml");
    rig.axis.slider.payload_kg = random.uniform(4.0, 12.0);
    rig.axis.slider.viscous_friction_Ns_per_m = random.uniform(5.0, 12.0);
    const RunResult run = simulated(rig);
    INFO("seed " << seed << ", " << rig.axis.slider.payload_kg << " kg: " << said(run));
    CHECK(run.verdict.following == Following::does_not_follow);
    CHECK((run.verdict.oscillates || run.verdict.touched_end_stop));
  }
}
