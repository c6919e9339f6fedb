// The plots of a run: what the deviation plot shows of measured and predicted position.
#include <catch2/catch.hpp>

#include <cmath>

#include <report/run_plots.hpp>

#include "report/synthetic_rows.hpp"

using namespace pneuservo;

namespace {

constexpr double period_s = 1e-3, start_s = 0.5, limit_m = 5e-3;

/// An axis that leaves its prediction, known from 0.2 s on, at 3 mm/s, with a fault at 1.8 s.
RunResult drifting() {
  RunResult run;
  run.pressure_source = "estimated";
  run.start_s = start_s;
  run.deviation_limit_m = limit_m;
  run.rows = test::make_rows(2.0, period_s, [](Row& row) {
    row.measured[Signal::x] = 0.08 * test::wave(1.0, row.t_s);
    if (row.t_s >= 0.2) row.x_predicted_m = row.measured[Signal::x] - 3e-3 * row.t_s;
    if (row.t_s >= 1.8) row.flags = row_fault;
  });
  run.faults = {"deviation: too far"};
  return run;
}

RunReport report_of(std::vector<RunResult> runs) {
  RunReport report;
  report.runs = std::move(runs);
  return report;
}

}  // namespace

TEST_CASE("the deviation plot shows measured less predicted position, the permitted band and the fault") {
  const Plot plot = deviation_plot(report_of({drifting()}), period_s);
  REQUIRE(plot.unit == "mm");
  REQUIRE(plot.curves.size() == 1);
  const Curve& curve = plot.curves[0];
  REQUIRE(curve.y.size() == 2000);
  for (std::size_t i = 0; i < curve.y.size(); ++i) {
    const double t_s = period_s * static_cast<double>(i);
    CAPTURE(i);
    REQUIRE(curve.x[i] == Approx(t_s - start_s).margin(1e-12));
    if (i < 200) REQUIRE(std::isnan(curve.y[i]));
    else REQUIRE(curve.y[i] == Approx(3.0 * t_s).margin(1e-9));
  }
  REQUIRE(plot.bands.size() == 1);
  REQUIRE(plot.bands[0].name == "limits.deviation_m");
  REQUIRE(plot.bands[0].x.front() == Approx(-start_s));
  REQUIRE(plot.bands[0].x.back() == Approx(1.999 - start_s));
  REQUIRE(plot.bands[0].low.back() == Approx(-5.0));
  REQUIRE(plot.bands[0].high.back() == Approx(5.0));
  REQUIRE(plot.marks.size() == 1);
  REQUIRE(plot.marks[0].x == Approx(1.8 - start_s));
}

TEST_CASE(
    "the deviation plot has one band for all runs, none where nothing is checked, no curve without a prediction") {
  RunResult second = drifting();
  second.pressure_source = "valve";
  const Plot both = deviation_plot(report_of({drifting(), second}), period_s);
  REQUIRE(both.curves.size() == 2);
  REQUIRE(both.bands.size() == 1);
  RunResult unchecked = drifting();
  unchecked.deviation_limit_m = std::nan("");
  REQUIRE(deviation_plot(report_of({unchecked}), period_s).bands.empty());
  RunResult blind = drifting();
  for (Row& row : blind.rows) row.x_predicted_m = Row::none;
  REQUIRE(deviation_plot(report_of({blind}), period_s).curves.empty());
}
