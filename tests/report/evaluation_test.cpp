// Figures of a run: known sines, ripples and moves give known errors, windows and end errors.
#include <catch2/catch.hpp>

#include <report/evaluation.hpp>
#include <report/high_pass.hpp>

#include "synthetic_rows.hpp"

using namespace pneuservo;
using test::make_rows;
using test::wave;

namespace {

Rig sine_rig() {
  Rig rig;
  rig.reference.kind = ReferenceKind::sine;
  rig.reference.amplitude_m = 0.08;
  rig.reference.frequency_Hz = 1.0;
  return rig;
}

/// 10 s at 1 ms: 3 mm error and estimation errors of 640 and 200 Pa in the second half, far more in the first.
std::vector<Row> sine_rows() {
  return make_rows(10.0, 1e-3, [](Row& row) {
    const double scale = row.t_s < 5.0 ? 10.0 : 1.0;
    row.x_ref_m = 0.08 * wave(1.0, row.t_s);
    row.x_true_m = row.x_ref_m - scale * 0.003 * wave(2.0, row.t_s);
    row.measured[Signal::x] = row.x_true_m + 0.02;
    row.p1_chamber_true_Pa = 4e5;
    row.p2_chamber_true_Pa = 5e5;
    row.p1_estimated_Pa = 4e5 + scale * 640.0 * wave(1.0, row.t_s);
    row.p2_estimated_Pa = 5e5 - scale * 200.0 * wave(1.0, row.t_s);
    row.u_V = (std::llround(row.t_s * 1e3) % 2 == 0 ? 1.0 : -1.0) * 0.0025;
  });
}

}  // namespace

TEST_CASE("a sine is judged over the second half of the run, against the true position") {
  const Metrics metrics = evaluate(sine_rig(), sine_rows());
  REQUIRE(metrics.from_s == Approx(5.0));
  REQUIRE(metrics.to_s == Approx(9.999));
  REQUIRE(metrics.position_is_true);
  REQUIRE(metrics.max_position_error_m == Approx(0.003).epsilon(1e-4));
  REQUIRE(metrics.rms_position_error_m == Approx(0.003 / std::sqrt(2.0)).epsilon(1e-4));
  REQUIRE(metrics.max_estimation_error_Pa == Approx(640.0).epsilon(1e-4));
  REQUIRE(metrics.rms_estimation_error_Pa == Approx(640.0 / std::sqrt(2.0)).epsilon(1e-4));
  REQUIRE(metrics.command_step_rms_V == Approx(0.005));
}

TEST_CASE("a stretch of lost rows leaves the figures to the others") {
  auto rows = sine_rows();
  rows.erase(rows.begin() + 7000, rows.begin() + 7030);
  const Metrics metrics = evaluate(sine_rig(), rows);
  REQUIRE(metrics.max_position_error_m == Approx(0.003).epsilon(1e-4));
  REQUIRE(metrics.rms_position_error_m == Approx(0.003 / std::sqrt(2.0)).epsilon(5e-3));
  REQUIRE(metrics.rms_estimation_error_Pa == Approx(640.0 / std::sqrt(2.0)).epsilon(5e-3));
}

TEST_CASE("without truth the encoder is judged, and there is no estimation error") {
  auto rows = sine_rows();
  for (Row& row : rows) row.x_true_m = row.p1_chamber_true_Pa = row.p2_chamber_true_Pa = Row::none;
  const Metrics metrics = evaluate(sine_rig(), rows);
  REQUIRE_FALSE(metrics.position_is_true);
  REQUIRE(metrics.max_position_error_m == Approx(0.023).epsilon(1e-4));
  REQUIRE(std::isnan(metrics.max_estimation_error_Pa));
  REQUIRE(std::isnan(metrics.rms_estimation_error_Pa));
  REQUIRE(std::isnan(metrics.chamber_pressure_ripple_Pa));
}

TEST_CASE("the config's window wins, is counted from the start of the reference and is cut to the rows") {
  Rig rig = sine_rig();
  rig.evaluation = EvaluationParameters{1.0, 2.0};
  Metrics metrics = evaluate(rig, sine_rows());
  REQUIRE(metrics.max_position_error_m == Approx(0.030).epsilon(1e-4));
  metrics = evaluate(rig, sine_rows(), 5.0);
  REQUIRE(metrics.max_position_error_m == Approx(0.003).epsilon(1e-4));
  rig.evaluation = EvaluationParameters{6.0, 20.0};
  REQUIRE(evaluate(rig, sine_rows()).to_s == Approx(9.999));
  rig.evaluation = EvaluationParameters{12.0, 20.0};
  REQUIRE(std::isnan(evaluate(rig, sine_rows()).max_position_error_m));
  REQUIRE(std::isnan(evaluate(rig, {}).max_position_error_m));
}

TEST_CASE("a move is judged from its start to 0.6 s after its end, the end error is the mean over the last 0.1 s") {
  Rig rig;
  rig.reference.kind = ReferenceKind::minimum_jerk;
  rig.reference.end_m = 0.1;
  rig.reference.start_s = 0.5;
  rig.reference.duration_s = 1.0;
  const auto rows = make_rows(4.0, 1e-3, [](Row& row) {
    const bool inside = row.t_s > 0.4995 && row.t_s < 2.1005;
    row.x_ref_m = 0.1;
    row.measured[Signal::x] = 0.1 + (inside ? -0.002 : 0.5);
    if (row.t_s > 2.0005 && inside) row.measured[Signal::x] = 0.1 + 4e-5 + 1e-5 * wave(100.0, row.t_s);
  });
  const Metrics metrics = evaluate(rig, rows);
  REQUIRE(metrics.from_s == Approx(0.5));
  REQUIRE(metrics.to_s == Approx(2.1));
  REQUIRE(metrics.max_position_error_m == Approx(0.002));
  REQUIRE(metrics.end_error_m == Approx(-4e-5).epsilon(1e-6));
}

TEST_CASE("the window follows from the kind of reference") {
  ReferenceSpec waypoints;
  waypoints.kind = ReferenceKind::waypoints;
  waypoints.times_s = {0.2, 1.0, 1.7};
  waypoints.positions_m = {0.0, 0.05, 0.02};
  ReferenceSpec cruise;
  cruise.kind = ReferenceKind::cruise;
  cruise.start_m = 0.05, cruise.end_m = -0.05, cruise.speed_mps = 0.05, cruise.ramp_s = 0.15, cruise.start_s = 0.1;
  ReferenceSpec sum;
  sum.kind = ReferenceKind::sum;
  sum.parts = {waypoints, cruise};
  const auto window = [](const ReferenceSpec& reference) {
    Rig rig = sine_rig();
    rig.reference = reference;
    return evaluation_window(rig, 8.0);
  };
  REQUIRE(window(waypoints).from_s == Approx(0.2));
  REQUIRE(window(waypoints).to_s == Approx(1.7 + 0.6));
  REQUIRE(window(cruise).to_s == Approx(2.25 + 0.6));
  REQUIRE(window(sum).from_s == Approx(0.1));
  REQUIRE(window(sum).to_s == Approx(2.25 + 0.6));
  sum.parts.push_back(sine_rig().reference);
  REQUIRE(window(sum).from_s == Approx(4.0));
  REQUIRE(window(sum).to_s == Approx(8.0));
  ReferenceSpec rest = sine_rig().reference;
  rest.amplitude_m = 0.0;
  REQUIRE(window(rest).from_s == Approx(4.0));
  ReferenceSpec file;
  file.kind = ReferenceKind::file;
  file.path = "not read here";
  sum.parts.push_back(file);
  REQUIRE(window(sum).from_s == 0.0);
  REQUIRE(window(sum).to_s == Approx(8.0));
}

TEST_CASE("ripple is the peak to peak of what is faster than 3.5 Hz, of the chamber that has more of it") {
  const auto ripple = [](double frequency_Hz, double drift_Pa_per_s) {
    const auto rows = make_rows(6.0, 1e-3, [&](Row& row) {
      row.p1_chamber_true_Pa = 4e5 + 1000.0 * wave(frequency_Hz, row.t_s) + drift_Pa_per_s * row.t_s;
      row.p2_chamber_true_Pa = 5e5 + 50.0 * wave(frequency_Hz, row.t_s);
      row.measured[Signal::p1_chamber] = row.p1_chamber_true_Pa + 1e4 * wave(20.0, row.t_s);
    });
    return evaluate(sine_rig(), rows).chamber_pressure_ripple_Pa;
  };
  const auto gain = [](double frequency_Hz) {
    const double ratio = std::pow(frequency_Hz / ripple_corner_Hz, 4.0);
    return ratio / (1.0 + ratio);
  };
  REQUIRE(ripple(10.0, 0.0) == Approx(2000.0).epsilon(0.02));
  REQUIRE(ripple(10.0, 0.0) == Approx(2000.0 * gain(10.0)).epsilon(0.002));
  REQUIRE(ripple(30.0, 3e4) == Approx(2000.0).epsilon(0.002));
  REQUIRE(ripple(0.5, 0.0) < 2.0);
  REQUIRE(ripple(3.5, 0.0) == Approx(1000.0).epsilon(0.002));
}

TEST_CASE("ripple takes measured chamber pressures where there is no truth, and bridges lost rows") {
  auto rows =
      make_rows(6.0, 1e-3, [](Row& row) { row.measured[Signal::p2_chamber] = 5e5 + 700.0 * wave(20.0, row.t_s); });
  rows.erase(rows.begin() + 4000);
  rows[4500].measured[Signal::p2_chamber] = Row::none;
  REQUIRE(evaluate(sine_rig(), rows).chamber_pressure_ripple_Pa == Approx(1400.0).epsilon(0.005));
}

TEST_CASE("the high-pass shifts nothing in time and passes no constant") {
  std::vector<double> samples(4000, 7.0);
  for (double value : zero_phase_high_pass(samples, 1e-3, 3.5)) REQUIRE(std::fabs(value) < 1e-9);
  for (std::size_t k = 0; k < samples.size(); ++k) samples[k] = wave(20.0, 1e-3 * static_cast<double>(k));
  const auto fast = zero_phase_high_pass(samples, 1e-3, 3.5);
  for (std::size_t k = 1000; k < 3000; ++k) REQUIRE(fast[k] == Approx(samples[k]).margin(2e-3));
  REQUIRE(zero_phase_high_pass({1.0, 2.0}, 1.0, 3.5) == std::vector<double>{0.0, 0.0});
}
