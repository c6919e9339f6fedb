// Flow feedforward: steady motion gets the flow it needs, the force rate comes out as asked, line losses, lead.
#include <catch2/catch.hpp>

#include <random>

#include <pneuservo/control/flow_feedforward.hpp>

#include "control/test_axis.hpp"
#include "core/test_seed.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {
constexpr double r_t = 287.0 * 293.0;
/// Where both edges pass the same flow: filling and emptying need one area.
double even_pressure_Pa(const Air<double>& air) {
  double low = 150e3, high = 690e3;
  const auto mismatch = [&](double p) {
    return orifice_flux(air, 700e3, 293.0, p, 0.35) - orifice_flux(air, p, 293.0, 101325.0, 0.35);
  };
  for (int i = 0; i < 100; ++i) (mismatch(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
  return low;
}
}  // namespace

TEST_CASE("the steady line loss follows 64/Re, Blasius and the line between") {
  const Air<double> air{AirParameters<double>{}};
  const double d = 0.00765, length = 10.0, area = M_PI / 4 * d * d, p = 470e3, rho = p / r_t;
  const SteadyLine<double> line(air, {.length_m = length, .diameter_m = d});
  const auto loss = [&](double reynolds, double lambda) {
    const double u = reynolds * 1.8e-5 / (rho * d);
    return lambda / (2.0 * d) * rho * u * u * length;
  };
  const auto flow = [&](double reynolds) { return reynolds * 1.8e-5 * area / d; };
  CHECK(steady_line_loss_Pa(line, flow(1500.0), p) == Approx(loss(1500.0, 64.0 / 1500.0)));
  CHECK(steady_line_loss_Pa(line, flow(30000.0), p) == Approx(loss(30000.0, 0.3164 * std::pow(30000.0, -0.25))));
  const double between = 64.0 / 2300.0 + (0.3164 * std::pow(4000.0, -0.25) - 64.0 / 2300.0) * 700.0 / 1700.0;
  CHECK(steady_line_loss_Pa(line, flow(3000.0), p) == Approx(loss(3000.0, between)));
  CHECK(steady_line_loss_Pa(line, -flow(3000.0), p) == -steady_line_loss_Pa(line, flow(3000.0), p));
  CHECK(steady_line_loss_Pa(line, 0.0, p) == 0.0);
  const SteadyLine<double> thesis(air, {.length_m = length, .diameter_m = d, .turbulent_reynolds = 2300.0});
  CHECK(steady_line_loss_Pa(thesis, flow(2301.0), p) == Approx(loss(2301.0, 0.3164 * std::pow(2301.0, -0.25))));
}

TEST_CASE("for slow steady motion of a symmetric axis the edges pass the flow that the motion needs") {
  AxisParameters<double> axis = symmetric_axis();
  const FlowFeedforward feedforward(axis);
  const Air<double> air(axis.air);
  const double p = even_pressure_Pa(air);
  ReferencePoint r;
  for (const double v : {0.002, -0.002, 0.005}) {
    r.d[1] = v;
    const double area = feedforward.area_m2(r, p, p);
    const double flow_1 = area * orifice_flux(air, 700e3, 293.0, p, 0.35);
    CHECK(flow_1 == Approx(p * axis.cylinder.area_1_m2 * v / r_t).epsilon(2e-3));
  }
}

TEST_CASE("the commanded area gives the force rate that the reference asks for") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const AxisParameters<double> axis = nominal_axis(0.05, 0.02);  // lines without loss
  const FlowFeedforward feedforward(axis);
  const Air<double> air(axis.air);
  for (int i = 0; i < 200; ++i) {
    ReferencePoint r;
    r.d = {0.1 * unit(random), 0.3 * unit(random), 2.0 * unit(random), 10.0 * unit(random)};
    const double p1 = 400e3 + 150e3 * unit(random), p2 = 400e3 + 150e3 * unit(random);
    const double area = feedforward.area_m2(r, p1, p2), size = std::fabs(area);
    // Chambers with their lines: V dp/dt = n (R T G - p dV/dt), each edge by the orifice itself.
    const double fill = orifice_flux(air, 700e3, 293.0, area >= 0.0 ? p1 : p2, 0.35),
                 empty = orifice_flux(air, area >= 0.0 ? p2 : p1, 293.0, 101325.0, 0.35);
    const double flow_1 = area >= 0.0 ? size * fill : -size * empty, flow_2 = area >= 0.0 ? -size * empty : size * fill;
    const double line = M_PI / 4 * 0.02 * 0.02 * 0.05, a1 = 1.257e-3, a2 = 1.056e-3;
    const double v1 = 2e-5 + a1 * (0.15 + r.d[0]) + line, v2 = 2e-5 + a2 * (0.15 - r.d[0]) + line;
    const double dp1 = 1.3 * (r_t * flow_1 - p1 * a1 * r.d[1]) / v1, dp2 = 1.3 * (r_t * flow_2 + p2 * a2 * r.d[1]) / v2;
    const double wanted = 2.0 * r.d[3] + 60.0 * r.d[2];
    CAPTURE(r.d[1], p1, p2, area);
    REQUIRE(a1 * dp1 - a2 * dp2 == Approx(wanted).margin(0.01 * std::fabs(wanted) + 3.0));
  }
}

TEST_CASE("payload and friction enter the force of the motion, line loss enlarges the area") {
  AxisParameters<double> axis = nominal_axis();
  axis.slider.payload_kg = 1.25;
  ReferencePoint r;
  r.d = {0.0, 0.5, 2.0, 0.0};
  CHECK(FlowFeedforward(axis).motion_force_N(r) == Approx(3.25 * 2.0 + 60.0 * 0.5));
  const double wide = FlowFeedforward(nominal_axis(5.0, 0.00765)).area_m2(r, 470e3, 540e3);
  AxisParameters<double> narrow = nominal_axis(5.0, 0.00765);
  narrow.air.viscosity_Pas *= 10.0;  // the same volumes with more loss
  CHECK(FlowFeedforward(narrow).area_m2(r, 470e3, 540e3) > 1.005 * wide);
}

TEST_CASE("the lines lose what Darcy and Weisbach give for the flow that a slow motion needs") {
  // Of equal sides at even pressures each chamber takes what its piston sweeps.
  const AxisParameters<double> axis = symmetric_axis();
  const Air<double> air(axis.air);
  const FlowFeedforward feedforward(axis);
  const double p = even_pressure_Pa(air);
  ReferencePoint r;
  for (const double v : {0.02, -0.02}) {
    r.d[1] = v;
    const auto loss_Pa = feedforward.line_loss_Pa(r, p, p);
    const auto swept = [&](const LineParameters<double>& line, double area_m2, double speed_mps) {
      return steady_line_loss_Pa(SteadyLine<double>(air, line), p * area_m2 * speed_mps / r_t, p);
    };
    CHECK(loss_Pa[0] == Approx(swept(axis.line_1, axis.cylinder.area_1_m2, v)).epsilon(0.02));
    CHECK(loss_Pa[1] == Approx(swept(axis.line_2, axis.cylinder.area_2_m2, -v)).epsilon(0.02));
  }
}

TEST_CASE("pressures at supply and atmosphere keep the area finite") {
  const FlowFeedforward feedforward(nominal_axis());
  ReferencePoint r;
  r.d = {0.4, 0.5, 1.0, 10.0};  // beyond the stroke as well
  for (const double p1 : {50e3, 101325.0, 700e3, 900e3})
    for (const double p2 : {50e3, 101325.0, 700e3, 900e3}) CHECK(std::isfinite(feedforward.area_m2(r, p1, p2)));
}

TEST_CASE("the recommended lead is the one of the design for the nine lines") {
  const std::array<std::array<double, 3>, 9> known{{{7.65, 10, 9.3},
                                                    {7.65, 5, 2.5},
                                                    {7.65, 2, 0.4},
                                                    {6.10, 10, 18.2},
                                                    {6.10, 5, 4.9},
                                                    {6.10, 2, 0.8},
                                                    {4.15, 10, 56.6},
                                                    {4.15, 5, 15.0},
                                                    {4.15, 2, 2.5}}};
  for (const auto& [d_mm, length, lead_ms] : known) {
    CAPTURE(d_mm, length);
    CHECK(1e3 * feedforward_lead_s(nominal_axis(length, d_mm * 1e-3), 0.16 * M_PI, 470e3) ==
          Approx(lead_ms).epsilon(0.01).margin(0.05));
  }
}
