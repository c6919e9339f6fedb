// Plots of a law's terms: one a unit, with the values of the rows, without terms that keep one value.
#include <algorithm>
#include <string_view>

#include <catch2/catch.hpp>

#include <pneuservo/control/laws.hpp>

#include "report/run_plots.hpp"

using namespace pneuservo;

TEST_CASE("terms of one unit share a plot, a term that keeps one value has none") {
  const auto terms = law_terms(kind_of<PdForce>);
  const auto place = [&](std::string_view name) {
    const auto found = std::ranges::find(terms, name, [](const auto& term) { return term.name; });
    REQUIRE(found != terms.end());
    return static_cast<std::size_t>(found - terms.begin());
  };
  RunResult run;
  run.start_s = 0.5;
  for (int k = 0; k < 4; ++k) {
    Row row;
    row.t_s = 0.5 + 0.001 * k;
    row.terms.fill(7.0);
    row.terms[place("chamber_force_N")] = 100.0 + k;
    row.terms[place("force_error_N")] = -2.0 * k;
    row.terms[place("u_unlimited_V")] = k > 0 ? 0.1 * k : Row::none;  // none in the first row
    run.rows.push_back(row);
  }
  RunReport report;
  report.runs = {run};
  const std::vector<Plot> plots = term_plots(report, run, terms, 0.001);
  REQUIRE(plots.size() == 2);
  CHECK(plots[0].unit == "N");
  REQUIRE(plots[0].curves.size() == 2);
  CHECK(plots[0].curves[0].name == "chamber_force_N");
  CHECK(plots[0].curves[0].y == std::vector<double>{100.0, 101.0, 102.0, 103.0});
  CHECK(plots[0].curves[1].name == "force_error_N");
  CHECK(plots[0].curves[1].x.front() == 0.0);
  CHECK(plots[1].unit == "V");
  REQUIRE(plots[1].curves.size() == 1);
  CHECK(plots[1].curves[0].name == "u_unlimited_V");
}
