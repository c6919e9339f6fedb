// Linear models of third, fifth and seventh order: poles, reductions, inverse, against golden numbers and each other.
#include <catch2/catch.hpp>

#include "design/state_space.hpp"
#include "design/table_models.hpp"

using namespace pneuservo;
using namespace pneuservo::test;
using Complex = std::complex<double>;

namespace {
/// Each golden pole (a pair by its upper one) is among the poles, to the digits that are given.
void check_poles(const std::vector<Complex>& poles, const std::vector<Complex>& golden, double margin = 0.06) {
  for (const Complex& pole : golden) {
    double nearest = 1e300;
    for (const Complex& found : poles)
      nearest =
          std::min(nearest, std::max(std::fabs(found.real() - pole.real()), std::fabs(found.imag() - pole.imag())));
    INFO("pole " << pole.real() << " + " << pole.imag() << "j");
    CHECK(nearest < margin);
  }
}
}  // namespace

TEST_CASE("golden poles with ideal derivatives") {
  const LinearAxis axis_4 = golden_axis(table_4mm), axis_8 = golden_axis(table_8mm);
  check_poles(roots(closed_loop(axis_4, {1000, 64.8, 1.50})),
              {{-23.7, 0}, {-24.8, 41.2}, {-394.1, 445.7}, {-56.0, 663.5}});
  check_poles(roots(closed_loop(axis_4, table_4mm.gains_5)),
              {{-34.8, 0}, {-13.7, 40.6}, {-401.1, 445.8}, {-54.7, 667.4}});
  check_poles(roots(closed_loop(axis_8, table_8mm.gains_5)),
              {{-63.3, 0}, {-15.3, 33.3}, {-388.7, 452.7}, {-34.9, 604.5}});
  check_poles(roots(closed_loop(matched_at_low_frequency(axis_4), table_4mm.gains_5)),
              {{-34.8, 0}, {-13.7, 40.7}, {-208.3, 354.1}});
  check_poles(roots(closed_loop(matched_at_low_frequency(axis_8), table_8mm.gains_5)),
              {{-63.2, 0}, {-15.3, 33.3}, {-177.4, 347.4}});
}

TEST_CASE("the seventh-order loop has the coefficients of 2.31") {
  const TableCase& one = table_4mm;
  const double K = 45.580, wn2 = golden_axis(one).natural_frequency_squared(), zt = one.line.damping_ratio, zv = 0.7,
               wt = one.line.natural_frequency_rad_per_s, wv = cycle_rad * 100.0;
  const Ppd2Gains g = one.gains_5;
  const double wtv2 = wt * wt * wv * wv, cross = zt * wv + zv * wt;
  const Polynomial golden{K * g.position_V_per_m * wtv2,
                          wtv2 * (wn2 + K * g.velocity_Vs_per_m),
                          2 * wt * wv * wn2 * cross + K * g.acceleration_Vs2_per_m * wtv2,
                          wtv2 + wn2 * (wt * wt + wv * wv + 4 * zt * zv * wt * wv),
                          2 * ((zt * wt + zv * wv) * wn2 + wt * wv * cross),
                          wt * wt + wn2 + wv * wv + 4 * zt * zv * wt * wv,
                          2 * (zt * wt + zv * wv),
                          1.0};
  const Polynomial loop = closed_loop(golden_axis(one), g);
  REQUIRE(loop.size() == golden.size());
  for (std::size_t i = 0; i < loop.size(); ++i) CHECK(loop[i] == Approx(golden[i]).epsilon(1e-12));
}

TEST_CASE("reduction: low frequency keeps slope and curvature, pole distance keeps the line") {
  for (const TableCase* one : {&table_4mm, &table_8mm}) {
    const LinearAxis axis = golden_axis(*one), reduced = matched_at_low_frequency(axis);
    const SecondOrderLag same = low_frequency_match(axis.lines[0], axis.valve);
    CHECK(reduced.order() == 5);
    CHECK(reduced.lines[0].natural_frequency_rad_per_s == Approx(same.natural_frequency_rad_per_s));
    CHECK(reduced.lines[0].damping_ratio == Approx(same.damping_ratio));
  }
  const LinearAxis kept = reduced_by_pole_distance(golden_axis(table_4mm), {1000, 64.8, 1.50});
  CHECK(kept.lines[0].natural_frequency_rad_per_s / cycle_rad == Approx(106.0).margin(0.1));
  CHECK(kept.lines[0].damping_ratio == Approx(0.085).margin(0.001));
}

TEST_CASE("lines that differ: the match keeps their weighted sum, the model grows by two orders") {
  LinearAxis axis = golden_axis(table_4mm);
  axis.lines[1] = table_8mm.line;
  axis.weights = {0.6, 0.4};
  CHECK(axis.order() == 9);
  CHECK(without_lags(axis).order() == 3);
  const LinearAxis reduced = matched_at_low_frequency(axis);
  for (const double w : {1.0, 5.0}) {  // the difference is of third order in w
    const Complex s(0.0, w);
    const auto lag = [&](const LinearAxis& a) { return value_at(a.numerator(), s) / value_at(a.lag_denominator(), s); };
    CHECK(std::abs(lag(axis) - lag(reduced)) < 4.0 * std::pow(w / 400.0, 3));
  }
}

TEST_CASE("the inverse of the closed loop is the one that the controller uses") {
  for (const TableCase* one : {&table_4mm, &table_8mm}) {
    const LinearServoTable table = nominal_linear_table(*one);
    const LinearAxis axis = linear_axis(table);
    const struct {
      LinearAxis model;
      int order;
    } models[]{{without_lags(axis), 3}, {matched_at_low_frequency(axis), 5}, {axis, 7}};
    for (const auto& [model, order] : models) {
      const auto c = inverse_of_closed_loop(model, one->gains_5);
      const auto expected = feedforward_coefficients(table, one->gains_5, order);
      REQUIRE(c.size() == static_cast<std::size_t>(order));
      for (std::size_t i = 0; i < c.size(); ++i) CHECK(c[i] == Approx(expected[i + 1]).epsilon(1e-12));
    }
  }
}

TEST_CASE("the state-space form has the transfer function, held and delayed too") {
  LinearAxis axis = golden_axis(table_8mm);
  axis.lines[1] = table_4mm.line;
  axis.weights = {0.3, 0.7};
  axis.damping_per_s = 2.0;
  axis.stiffness_per_s2 = {900.0, 1200.0};
  axis.stiffening = {1.6, 1.2};
  const StateSpace system = continuous_axis(axis);
  REQUIRE(system.A.rows() == axis.order());
  const auto transfer = [&](Complex s) {
    return axis.gain_per_V * value_at(axis.numerator(), s) / value_at(axis.open_loop(), s);
  };
  for (const double w : {3.0, 40.0, 650.0}) {
    const Complex s(-1.0, w);
    const auto y = system.transfer(s);
    CHECK(std::abs(y(0, 0) / transfer(s) - 1.0) < 1e-9);
    CHECK(std::abs(y(2, 0) / (s * s * transfer(s)) - 1.0) < 1e-9);
  }
  // At frequencies far below sampling the held input is the continuous one behind half a period and the delay.
  for (const double delay : {0.0, 7e-5, 2e-4, 5.3e-4}) {
    const StateSpace sampled = held(system, table_period_s, delay);
    const Complex s(0.0, 20.0);
    const Complex expected = transfer(s) * std::exp(-s * (delay + 0.5 * table_period_s));
    CHECK(std::abs(sampled.transfer(std::exp(s * table_period_s))(0, 0) / expected - 1.0) < 2e-5);
  }
}
