// The printed moves on the linear plant behind a hold: the tables of the thesis' chapter 2 with our figures.
#include <catch2/catch.hpp>

#include <cmath>

#include "control/linear_table_trials.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {
constexpr double period_s = table_period_s;
}

TEST_CASE("the held linear plant is the continuous one for a constant command") {
  // Behind settled lags a constant command gives x''' + wn^2 x' = K u: a mean speed of K u/wn^2.
  const LinearServoTable table = nominal_linear_table(table_4mm);
  LinearTablePlant plant(table, period_s);
  plant.reset(0.01);
  const double u = 1e-4, mean = table.gain_per_V * u / table.natural_frequency_squared;
  const double cycle_s = cycle_rad / std::sqrt(table.natural_frequency_squared);
  const auto run = [&](double time_s) {
    for (long k = std::lround(time_s / period_s); k > 0; --k) plant.step(u);
    return plant.position_m();
  };
  const double begin_m = run(1.0);
  const double cycles = 10.0;
  CHECK((run(cycles * cycle_s) - begin_m) / (cycles * cycle_s) == Approx(mean).epsilon(2e-4));
  // The first-order hold-free limit: half a period as long gives the same motion.
  LinearTablePlant finer(table, 0.5 * period_s), coarse(table, period_s);
  for (int k = 0; k < 500; ++k) {
    coarse.step(std::sin(0.01 * k));
    finer.step(std::sin(0.01 * k));
    finer.step(std::sin(0.01 * k));
  }
  CHECK(finer.position_m() == Approx(coarse.position_m()).epsilon(1e-10));
  CHECK(finer.velocity_mps() == Approx(coarse.velocity_mps()).epsilon(1e-10));
}

TEST_CASE("printed moves with ideal derivatives") {
  // without, 3rd, 5th; printed 3270, 22.67, 1.60 (4 mm) and 3036, 21.50, 0.30 (8 mm).
  CHECK(with_ideal_derivatives_um(table_4mm, table_4mm.gains_3, 0) == Approx(3277.0).epsilon(0.003));
  CHECK(with_ideal_derivatives_um(table_4mm, table_4mm.gains_3, 3) == Approx(23.48).epsilon(0.005));
  CHECK(with_ideal_derivatives_um(table_4mm, table_4mm.gains_5, 5) == Approx(1.13).epsilon(0.01));
  CHECK(with_ideal_derivatives_um(table_8mm, table_8mm.gains_3, 0) == Approx(3029.0).epsilon(0.003));
  CHECK(with_ideal_derivatives_um(table_8mm, table_8mm.gains_3, 3) == Approx(20.99).epsilon(0.005));
  CHECK(with_ideal_derivatives_um(table_8mm, table_8mm.gains_5, 5) == Approx(0.81).epsilon(0.01));
}

TEST_CASE("shorter moves have the same error: it is made in the ramps") {
  for (const double way_m : {0.02, 0.05, 0.07}) {
    INFO(way_m);
    CHECK(with_ideal_derivatives_um(table_4mm, table_4mm.gains_3, 3, way_m) == Approx(23.48).epsilon(0.01));
    CHECK(with_ideal_derivatives_um(table_8mm, table_8mm.gains_5, 5, way_m) == Approx(0.81).epsilon(0.02));
  }
}

TEST_CASE("printed moves with the law and its observers") {
  struct Golden {
    LawCase law;
    double um_4, um_8, epsilon;
  };
  using F = FeedforwardKind;
  using O = ObserverInput;
  const Golden golden[]{{{F::order_3, O::measured, printed_observer, false}, 161.0, 146.0, 0.02},
                        {{F::order_5, O::measured, printed_observer, false}, 150.0, 153.0, 0.02},
                        {{F::order_3, O::error, printed_observer, false}, 20.6, 16.8, 0.02},
                        {{F::order_5, O::error, printed_observer, false}, 1.08, 0.70, 0.02},
                        {{F::order_5, O::error, printed_observer, true}, 0.18, 0.14, 0.04},
                        {{F::order_7, O::error, printed_observer, true}, 0.021, 0.019, 0.04},
                        {{F::order_3, O::error, 1000.0, false}, 22.9, 20.3, 0.02},
                        {{F::order_5, O::error, 1000.0, false}, 1.11, 0.79, 0.02},
                        {{F::order_7, O::error, 1000.0, true}, 0.018, 0.017, 0.04}};
  for (const Golden& g : golden) {
    const bool third = g.law.feedforward == F::order_3;
    INFO("feedforward " << static_cast<int>(g.law.feedforward) << ", observer " << g.law.observer_rad_per_s);
    CHECK(with_law_um(table_4mm, third ? table_4mm.gains_3 : table_4mm.gains_5, g.law) ==
          Approx(g.um_4).epsilon(g.epsilon));
    CHECK(with_law_um(table_8mm, third ? table_8mm.gains_3 : table_8mm.gains_5, g.law) ==
          Approx(g.um_8).epsilon(g.epsilon));
  }
  CHECK(with_law_um(table_4mm, table_4mm.gains_5, {F::order_7, O::error, 1000.0, true}) < 0.025);
  CHECK(with_law_um(table_8mm, table_8mm.gains_5, {F::order_7, O::error, 1000.0, true}) < 0.025);
}

TEST_CASE("gains of a stable loop settle, others do not") {
  Ppd2Parameters p;
  p.position_gain_V_per_m = 1200.0;
  p.velocity_gain_Vs_per_m = 54.0;
  p.acceleration_gain_Vs2_per_m = 1.3;
  AxisParameters<double> axis = table_axis(table_4mm);
  axis.line_1.natural_frequency_Hz = 110.0;
  axis.line_1.damping_ratio = 0.068;
  CHECK(linear_loop_settles(p, axis, period_s));
  // The loop is conditionally stable: margins 0.375 and 3.9 on all gains alike.
  for (const auto& [factor, settles] : {std::pair{0.5, true}, {0.3, false}, {3.5, true}, {4.3, false}}) {
    INFO(factor);
    Ppd2Parameters scaled = p;
    scaled.position_gain_V_per_m *= factor;
    scaled.velocity_gain_Vs_per_m *= factor;
    scaled.acceleration_gain_Vs2_per_m *= factor;
    CHECK(linear_loop_settles(scaled, axis, period_s) == settles);
  }
}
