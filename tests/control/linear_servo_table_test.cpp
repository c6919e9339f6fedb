// The servo table's linear models against golden numbers, and their inverse against its definition.
#include <catch2/catch.hpp>

#include <complex>
#include <vector>

#include "control/table_axis.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

TEST_CASE("constants of the linear model") {
  struct Golden {
    double equilibrium_Pa, supply_Pa, wn, delta, Kn;
  };
  // P0, Ps, wn, delta and K_n per m/(s m2).
  const Golden golden[]{{110e3, 251.3e3, 7.9663, 0.21693, 2.30011e5},
                        {110e3, 250e3, 7.9663, 0.21806, 2.29033e5},
                        {118e3, 251.3e3, 8.2509, 0.30270, 2.29530e5},
                        {110e3, 300e3, 7.9663, 0.18171, 2.66640e5}};
  for (const Golden& g : golden) {
    AxisParameters<double> axis = table_axis(table_4mm);
    axis.supply.pressure_Pa = g.supply_Pa;
    const LinearServoTable table = linear_servo_table(axis, g.equilibrium_Pa, table_4mm.line);
    INFO("P0 " << g.equilibrium_Pa << ", Ps " << g.supply_Pa);
    CHECK(std::sqrt(table.natural_frequency_squared) == Approx(g.wn).epsilon(1e-5));
    CHECK(table.discharge_ratio == Approx(g.delta).epsilon(3e-5));
    CHECK(table.gain_per_V / (table.natural_frequency_squared * axis.valve.area_per_volt_m2_per_V) ==
          Approx(g.Kn).epsilon(3e-6));
  }
  CHECK(linear_servo_table(table_axis(table_4mm), 110e3, table_4mm.line).gain_per_V == Approx(45.580).epsilon(2e-4));
}

TEST_CASE("a choked exhaust discharges with the ratio of the pressures") {
  // Pa/P0 below b: psi is 1.
  AxisParameters<double> axis = table_axis(table_4mm);
  axis.supply.pressure_Pa = 600e3;
  CHECK(linear_servo_table(axis, 300e3, table_4mm.line).discharge_ratio == Approx(0.5));
}

TEST_CASE("the fifth-order lag matches valve and line at low frequency") {
  const LinearServoTable a = nominal_linear_table(table_4mm), b = nominal_linear_table(table_8mm);
  const SecondOrderLag lag_4 = low_frequency_match(a.line, a.valve), lag_8 = low_frequency_match(b.line, b.valve);
  CHECK(lag_4.natural_frequency_rad_per_s == Approx(444.34).margin(0.005));
  CHECK(lag_4.damping_ratio == Approx(0.53875).margin(5e-6));
  CHECK(lag_8.natural_frequency_rad_per_s == Approx(434.31).margin(0.005));
  CHECK(lag_8.damping_ratio == Approx(0.51639).margin(5e-6));
  // A spool that follows at once leaves the line alone.
  const SecondOrderLag alone = low_frequency_match(a.line, {});
  CHECK(alone.natural_frequency_rad_per_s == Approx(a.line.natural_frequency_rad_per_s));
  CHECK(alone.damping_ratio == Approx(a.line.damping_ratio));
}

TEST_CASE("golden feedforward coefficients") {
  struct Golden {
    const TableCase& one;
    int order;
    std::vector<double> c;
  };
  const Golden golden[]{
      {table_4mm, 3, {5.29102e-2, 1.39167e-3, 1.82829e-5}},
      {table_4mm, 5, {4.61602e-2, 1.08615e-3, 1.82887e-5, 4.43349e-8, 9.26007e-11}},
      {table_4mm, 7, {4.61602e-2, 1.08615e-3, 1.82887e-5, 4.43409e-8, 9.26068e-11, 9.43928e-14, 9.69482e-17}},
      {table_8mm, 3, {4.91282e-2, 1.19333e-3, 1.46263e-5}},
      {table_8mm, 5, {4.09282e-2, 1.20221e-3, 1.46312e-5, 3.47808e-8, 7.75408e-11}},
      {table_8mm, 7, {4.09282e-2, 1.20221e-3, 1.46312e-5, 3.47862e-8, 7.75465e-11, 8.48952e-14, 9.02017e-17}}};
  for (const Golden& g : golden) {
    const Ppd2Gains& gains = g.order == 3 ? g.one.gains_3 : g.one.gains_5;
    const auto c = feedforward_coefficients(nominal_linear_table(g.one), gains, g.order);
    CHECK(c[0] == 1.0);
    for (std::size_t i = 1; i < c.size(); ++i) {
      INFO(g.one.name << ", order " << g.order << ", c" << i);
      if (i <= g.c.size()) CHECK(c[i] == Approx(g.c[i - 1]).epsilon(1.0e-5));
      else CHECK(c[i] == 0.0);
    }
  }
}

TEST_CASE("the inverse of order seven undoes valve, line and actuator at every frequency") {
  using Complex = std::complex<double>;
  const LinearServoTable table = nominal_linear_table(table_8mm);
  const auto a = inverse_coefficients(table, 7);
  const auto lag = [](const SecondOrderLag& l, Complex s) {
    const double w = l.natural_frequency_rad_per_s;
    return w * w / (s * s + 2.0 * l.damping_ratio * w * s + w * w);
  };
  for (const double w : {1.0, 10.0, 100.0, 640.0, 3000.0}) {
    const Complex s(0.0, w);
    Complex inverse = 0.0;
    for (std::size_t i = 8; i-- > 0;) inverse = inverse * s + a[i];
    const Complex plant =
        table.gain_per_V * lag(table.line, s) * lag(table.valve, s) / (s * (s * s + table.natural_frequency_squared));
    CHECK(std::abs(inverse * plant - 1.0) < 1e-12);
  }
  for (const double value : inverse_coefficients(table, 0)) CHECK(value == 0.0);
}
