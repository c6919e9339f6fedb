// The estimator against converged solutions: recorded ones (twelve where the shared data is at hand, else the three of
// tests/data/golden), and one made here.
#include <catch2/catch.hpp>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <zlib.h>

#include <pneuservo/estimator/axis_estimator.hpp>
#include <pneuservo/rig/plant.hpp>

#include "rig/nominal_axis.hpp"

using namespace pneuservo;
using test::nominal_axis;

namespace {
using P = Pack<double, 2>;

AxisEstimator<P> make_estimator(const AxisParameters<double>& axis, double cells_per_m) {
  using Plant = AxisPlant<double>;
  AxisEstimator<P> estimator;
  estimator.configure(Plant::join_parameters<LineParameters<P>>(axis.line_1, axis.line_2), Plant::side_geometry(axis),
                      Plant::join_parameters<AirParameters<P>>(axis.air, axis.air), P(0.5 * axis.cylinder.stroke_m),
                      join(1.0, -1.0), 1e-3, cell_count(axis.line_1.length_m, cells_per_m));
  return estimator;
}

struct Row {
  double t_s, x_m, u_V, p_port[2], p_chamber[2];
};
std::vector<Row> read_recording(const std::string& path) {
  std::vector<Row> rows;
  gzFile file = gzopen(path.c_str(), "rb");
  REQUIRE(file);
  char line[512];
  while (gzgets(file, line, sizeof line)) {
    Row r{};
    if (std::sscanf(line, "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &r.t_s, &r.x_m, &r.u_V, &r.p_port[0], &r.p_port[1],
                    &r.p_chamber[0], &r.p_chamber[1]) == 7)
      rows.push_back(r);
  }
  gzclose(file);
  return rows;
}

// Largest error of both chambers after one second, 1 m cells at 1 ms, started at the first port pressures.
double largest_error(const std::vector<Row>& rows, double L, double D) {
  AxisEstimator<P> estimator = make_estimator(nominal_axis(L, D), 1.0);
  estimator.reset(join(rows[0].p_port[0], rows[0].p_port[1]), rows[0].x_m);
  double worst = 0.0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    estimator.step(join(rows[k].p_port[0], rows[k].p_port[1]), rows[k].x_m);
    if (rows[k].t_s <= 1.0) continue;
    const P p = estimator.chamber_pressure();
    worst = std::max({worst, std::fabs(low(p) - rows[k].p_chamber[0]), std::fabs(high(p) - rows[k].p_chamber[1])});
  }
  return worst;
}
}  // namespace

TEST_CASE("estimator meets the recorded converged solutions") {
  const char* shared = std::getenv("PNEUSERVO_SHARED");
  std::filesystem::path folder =
      std::filesystem::path(shared ? shared : PNEUSERVO_SOURCE_DIR "/../shared") / "design/golden";
  const bool has_all = std::filesystem::exists(folder);
  if (!has_all) folder = PNEUSERVO_SOURCE_DIR "/tests/data/golden";
  int seen = 0;
  for (const auto& [D_mm, limit] : {std::pair{"7.65", 125.0}, {"6.10", 180.0}, {"4.15", 460.0}}) {
    for (const auto& [L, name] : {std::pair{2.0, "2m"}, {5.0, "5m"}, {10.0, "10m"}}) {
      for (const bool held : {false, true}) {
        const auto path =
            folder / ((held ? "held_steps_" : "closed_loop_") + std::string(name) + "_" + D_mm + "mm.csv.gz");
        if (!std::filesystem::exists(path)) continue;
        const std::vector<Row> rows = read_recording(path.string());
        REQUIRE(rows.size() > 1400);
        const double error = largest_error(rows, L, std::atof(D_mm) * 1e-3);
        CAPTURE(path.filename().string(), error);
        CHECK(error <= (held ? 3500.0 : limit));
        ++seen;
      }
    }
  }
  CHECK(seen == (has_all ? 12 : 3));
}

// The plant itself on ever finer grids: the estimator at 1 cell/m must lie near the limit, and the plants approach it.
TEST_CASE("estimator at 1 m cells stays near the plant that is refined, held piston, smooth valve motion") {
  const double L = 10.0, D = 7.65e-3;
  const AxisParameters<double> axis = nominal_axis(L, D);
  std::vector<std::vector<Row>> runs;
  for (const double cells_per_m : {10.0, 20.0}) {
    AxisPlant<double> plant;
    plant.configure(axis, 1e-3, cells_per_m);
    plant.reset({0.0, 470e3, 470e3});
    plant.hold_piston(true);
    std::vector<Row> rows;
    for (int k = 0; k < 2500; ++k) {
      Row r{k * 1e-3, 0.0, 0.0, {470e3, 470e3}, {470e3, 470e3}};
      if (k > 0) {
        const P port = plant.port_pressure(), chamber = plant.chamber_pressure();
        r = {k * 1e-3, 0.0, 0.0, {low(port), high(port)}, {low(chamber), high(chamber)}};
      }
      rows.push_back(r);
      plant.step(2.0 * std::sin(2.0 * M_PI * 2.0 * k * 1e-3));
    }
    runs.push_back(rows);
  }
  double between_plants = 0.0, swing = 0.0;
  for (std::size_t k = 1000; k < runs[0].size(); ++k)
    for (int i = 0; i < 2; ++i) {
      between_plants = std::max(between_plants, std::fabs(runs[0][k].p_chamber[i] - runs[1][k].p_chamber[i]));
      swing = std::max(swing, std::fabs(runs[1][k].p_chamber[i] - runs[1][k].p_port[i]));
    }
  const double error = largest_error(runs[1], L, D);
  CAPTURE(between_plants, swing, error);
  CHECK(swing > 3000.0);            // the line does something here
  CHECK(between_plants < 200.0);    // the plants have converged
  CHECK(error < 600.0);
  CHECK(error < 0.1 * swing);
}
