// Figures of a run that controls a pressure, on rows whose answers are known.
#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

#include <report/pressure_metrics.hpp>
#include <report/pressure_report.hpp>
#include <report/run_summary.hpp>

using namespace pneuservo;

namespace {

/// The reference goes from 300 to 400 kPa at 1 s; the pressure follows by 1 - e^(-t/0.1 s), with a bump of 2 kPa at 2
/// s.
std::vector<Row> step_rows() {
  std::vector<Row> rows;
  for (int i = 0; i < 3000; ++i) {
    Row row;
    row.t_s = 1e-3 * i;
    row.p_ref_Pa = i < 1000 ? 3e5 : 4e5;
    row.p1_chamber_true_Pa = i < 1000 ? 3e5 : 4e5 - 1e5 * std::exp(-(row.t_s - 1.0) / 0.1) + (i == 2000 ? 2e3 : 0.0);
    row.p1_estimated_Pa = row.p1_chamber_true_Pa + 150.0;
    row.u_V = i % 2 == 0 ? 0.0 : 0.01;
    rows.push_back(row);
  }
  return rows;
}

Rig a_rig() {
  Rig rig;
  rig.kind = RigKind::pressure;
  rig.duration_s = 3.0;
  return rig;
}

}  // namespace

TEST_CASE("a step's overshoot, settling and error from then on") {
  const PressureMetrics m = evaluate_pressure(a_rig(), step_rows(), 0.0);
  REQUIRE(m.steps.size() == 1);
  CHECK(m.steps[0].from_Pa == 3e5);
  CHECK(m.steps[0].to_Pa == 4e5);
  CHECK(m.pressure == "true");
  CHECK(m.max_overshoot_share == Approx(0.02).epsilon(0.01));
  CHECK(m.max_settling_s == Approx(0.1 * std::log(20.0)).margin(2e-3));  // e^(-t/0.1) = 5 %
  CHECK(m.max_settled_error_Pa == Approx(2e3).epsilon(0.01));  // the bump, where the rest is 5 Pa off
  CHECK(m.max_error_Pa == Approx(1e5));
  CHECK(m.max_estimation_error_Pa == Approx(150.0));
  CHECK(m.command_step_rms_V == Approx(0.01));
}

TEST_CASE("a step that never settles says so, and rows from a fault on do not count") {
  std::vector<Row> rows = step_rows();
  for (Row& row : rows) row.p1_chamber_true_Pa = 3e5;
  CHECK(std::isnan(evaluate_pressure(a_rig(), rows, 0.0).max_settling_s));
  rows = step_rows();
  for (std::size_t i = 1100; i < rows.size(); ++i) rows[i].fault = 1, rows[i].p1_estimated_Pa = 0.0;
  const PressureMetrics m = evaluate_pressure(a_rig(), rows, 0.0);
  CHECK(m.max_estimation_error_Pa == Approx(150.0));
  CHECK(m.to_s == Approx(1.099));
}

TEST_CASE("without truth the sensor's pressure counts, without a sensor the estimate") {
  std::vector<Row> rows = step_rows();
  for (Row& row : rows) row.measured[Signal::p1_chamber] = row.p1_chamber_true_Pa, row.p1_chamber_true_Pa = Row::none;
  CHECK(evaluate_pressure(a_rig(), rows, 0.0).pressure == "measured");
  for (Row& row : rows) row.measured[Signal::p1_chamber] = Row::none;
  const PressureMetrics m = evaluate_pressure(a_rig(), rows, 0.0);
  CHECK(m.pressure == "estimated");
  CHECK(std::isnan(m.max_estimation_error_Pa));
}

TEST_CASE("the headline tells steps, estimate and faults") {
  RunReport report;
  report.runs.emplace_back();
  RunResult& run = report.runs.front();
  run.pressure_source = "estimated";
  run.pressure = evaluate_pressure(a_rig(), step_rows(), 0.0);
  CHECK_THAT(headline(report), Catch::Contains("1 step, 2.00 % overshoot, settled after 0.300 s"));
  CHECK_THAT(headline(report), Catch::Contains("The estimate is off by 0.150 kPa at most."));
  run.faults = {"supply_low: the measured supply"};
  run.fault_s = 2.5;
  CHECK_THAT(headline(report), Catch::Contains("ended by the fault supply_low at 2.50 s"));
}
