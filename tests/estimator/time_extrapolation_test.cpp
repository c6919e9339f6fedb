// The extrapolated estimator: what is left of its error is that of the grid, whatever the step.
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "estimator/nominal_estimator.hpp"

using namespace pneuservo;

namespace {

constexpr double period_s = 1e-3, start_Pa = 470e3, half_stroke_m = 0.15;
constexpr int periods = 1500;

double port_Pa(double t_s) { return start_Pa + 20e3 * std::sin(2 * M_PI * t_s) + 10e3 * std::sin(31.0 * t_s); }
double position_m(double t_s) { return 0.08 * std::sin(2 * M_PI * t_s); }

/// What an estimator of one side tells of every period after the start is forgotten: pressure [Pa], flow [kg/s].
struct Course {
  std::vector<double> chamber_Pa, flow_kgps;
};
/// Of steps that are `finer` times as short as the sampling period asks for.
Course course(bool extrapolates, int finer, double length_m = 10.0, int cells = 10) {
  const auto axis = test::nominal_axis(length_m, 0.00765);
  const auto& c = axis.cylinder;
  AxisEstimator<double> estimator;
  estimator.configure(axis.line_1, {c.area_1_m2, c.dead_volume_1_m3, c.wall_heat_W_per_m2K}, axis.air, half_stroke_m,
                      1.0, period_s / finer, cells, extrapolates);
  estimator.reset(start_Pa, position_m(0.0));
  Course out;
  for (int k = 1; k <= periods; ++k) {
    for (int i = 1; i <= finer; ++i) {  // between two samples the port is linear, as for the coarse one
      const double share = static_cast<double>(i) / finer, t_s = (k - 1 + share) * period_s;
      estimator.step(std::lerp(port_Pa((k - 1) * period_s), port_Pa(k * period_s), share), position_m(t_s));
    }
    if (2 * k < periods) continue;
    out.chamber_Pa.push_back(estimator.chamber_pressure());
    out.flow_kgps.push_back(estimator.flow().chamber_mass_flow_kgps);
  }
  return out;
}
double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::fabs(a[i] - b[i]));
  return largest;
}

}  // namespace

TEST_CASE("extrapolated, a step of a period tells what steps a hundred times as short tell on the same grid") {
  for (const auto& [length_m, cells] : {std::pair{10.0, 10}, std::pair{5.0, 5}, std::pair{2.0, 2}}) {
    CAPTURE(length_m);
    const Course fine = course(false, 100, length_m, cells), plain = course(false, 1, length_m, cells),
                 extrapolated = course(true, 1, length_m, cells);
    const double error_Pa = largest_difference(plain.chamber_Pa, fine.chamber_Pa);
    CHECK(error_Pa > 50.0);
    CHECK(largest_difference(extrapolated.chamber_Pa, fine.chamber_Pa) < 0.1 * error_Pa);
    CHECK(largest_difference(extrapolated.flow_kgps, fine.flow_kgps) <
          0.5 * largest_difference(plain.flow_kgps, fine.flow_kgps));
  }
}

TEST_CASE("extrapolated, half the step leaves a quarter of the error: it is of second order in time") {
  const Course fine = course(true, 64);
  std::array<double, 3> errors_Pa{};
  for (std::size_t i = 0; i < errors_Pa.size(); ++i)
    errors_Pa[i] = largest_difference(course(true, 1 << i).chamber_Pa, fine.chamber_Pa);
  CHECK(errors_Pa[1] < 0.35 * errors_Pa[0]);
  CHECK(errors_Pa[2] < 0.35 * errors_Pa[1]);
}

TEST_CASE(
    "the pipeline estimator extrapolates where it is asked to: it comes nearer to one of a period a tenth as long") {
  const auto chamber_1_Pa = [](bool extrapolates, int finer) {
    EstimatorParameters p = test::nominal_estimator();
    p.time_extrapolation = extrapolates;
    p.period_s = period_s / finer;
    p.uncertainty.port_noise_Pa = 0.0;
    PipelineEstimator estimator;
    estimator.configure(p);
    std::vector<double> out;
    for (int k = 1; k <= finer * periods; ++k) {
      const int before = (k - 1) / finer;
      const double share = static_cast<double>(k - before * finer) / finer, t_s = (before + share) * period_s;
      const double p_Pa = std::lerp(port_Pa(before * period_s), port_Pa((before + 1) * period_s), share);
      const auto told = estimator.step({p_Pa, 1030e3 - p_Pa, position_m(t_s), 0.5 * std::cos(2 * M_PI * t_s)});
      if (k % finer == 0 && 2 * k >= finer * periods) out.push_back(told.chamber_pressure_Pa[0]);
    }
    return out;
  };
  const std::vector<double> fine = chamber_1_Pa(true, 10);
  const double plain_Pa = largest_difference(chamber_1_Pa(false, 1), fine);
  CHECK(plain_Pa > 50.0);
  CHECK(largest_difference(chamber_1_Pa(true, 1), fine) < 0.1 * plain_Pa);
}

TEST_CASE(
    "the extrapolated pipeline estimator is the plain one where nothing changes, and finite beside missing samples") {
  EstimatorParameters p = test::nominal_estimator();
  PipelineEstimator plain, extrapolated;
  plain.configure(p);
  p.time_extrapolation = true;
  extrapolated.configure(p);
  for (int k = 0; k < 3000; ++k) {
    const EstimatorInput resting{400e3, 460e3, 0.02, 0.0};
    const auto a = plain.step(resting), b = extrapolated.step(resting);
    REQUIRE((a.chamber_pressure_Pa - b.chamber_pressure_Pa).abs().maxCoeff() < 1e-3);
  }
  for (int k = 0; k < 1000; ++k) {
    const double t_s = k * period_s, nan = std::nan("");
    const auto out = extrapolated.step({k % 5 == 0 ? nan : port_Pa(t_s), k > 500 ? nan : 930e3 - port_Pa(t_s),
                                        position_m(t_s), k % 7 == 0 ? nan : 0.0});
    REQUIRE(out.chamber_pressure_Pa.allFinite());
    REQUIRE(out.error_bound_Pa.allFinite());
  }
}
