// The axis built from the elements: mass books with every leak, the sealed axis, symmetry, coupling of slider and gas.
#include <catch2/catch.hpp>

#include <pneuservo/rig/plant.hpp>

#include "rig/nominal_axis.hpp"

using namespace pneuservo;
using test::nominal_axis;

namespace {
double mass_of(const AxisPlant<double>& plant, int side) {
  return lane(plant.sides().line().mass() + plant.sides().chamber().mass(), side);
}
}  // namespace

TEST_CASE("plant: a sealed axis keeps its gas, both sides apart, while it swings") {
  AxisPlant<double> plant;
  plant.configure(nominal_axis(), 1e-3, 1.0);
  plant.reset({0.05, 470e3, 300e3});
  const double m_1 = mass_of(plant, 0), m_2 = mass_of(plant, 1);
  double farthest = 0.0;
  for (int k = 0; k < 5000; ++k) {
    plant.step(0.0);
    farthest = std::max(farthest, std::fabs(plant.position() - 0.05));
  }
  CHECK(farthest > 0.02);
  CHECK(mass_of(plant, 0) == Approx(m_1).epsilon(1e-12));
  CHECK(mass_of(plant, 1) == Approx(m_2).epsilon(1e-12));
}

TEST_CASE("plant: with one sub-step a period the mass of each side is what has been booked at its ports") {
  AxisPlant<double> plant;
  plant.configure(nominal_axis(), 2e-4, 1.0);
  plant.reset({0.0, 470e3, 540e3});
  double m_1 = mass_of(plant, 0), m_2 = mass_of(plant, 1);
  for (int k = 0; k < 10000; ++k) {
    plant.step((k / 1500) % 2 ? -3.0 : 3.0);
    m_1 += 2e-4 * low(plant.flow().port_mass_flow_kgps);
    m_2 += 2e-4 * high(plant.flow().port_mass_flow_kgps);
  }
  CHECK(mass_of(plant, 0) == Approx(m_1).epsilon(1e-12));
  CHECK(mass_of(plant, 1) == Approx(m_2).epsilon(1e-12));
}

TEST_CASE("plant: a chamber leak discharges to atmosphere, a piston leak only moves gas across") {
  AxisParameters<double> axis = nominal_axis();
  axis.effects.piston_leak.area_m2 = 1e-7;
  AxisPlant<double> plant;
  plant.configure(axis, 1e-3, 1.0);
  plant.reset({0.0, 600e3, 300e3});
  plant.hold_piston(true);
  const double total = mass_of(plant, 0) + mass_of(plant, 1), m_1 = mass_of(plant, 0);
  plant.step(0.0);
  const double expected = orifice_mass_flow(Air<double>{}, 1e-7, 0.35, 600e3, 293.0, 300e3, 293.0);
  CHECK(m_1 - mass_of(plant, 0) == Approx(1e-3 * expected).epsilon(1e-3));
  for (int k = 0; k < 60000; ++k) plant.step(0.0);
  CHECK(mass_of(plant, 0) + mass_of(plant, 1) == Approx(total).epsilon(1e-12));
  CHECK(low(plant.chamber_pressure()) == Approx(high(plant.chamber_pressure())).epsilon(1e-6));
  axis = nominal_axis();
  axis.effects.chamber_leak_1.area_m2 = 1e-6;
  plant.configure(axis, 1e-3, 1.0);
  plant.reset({0.0, 600e3, 300e3});
  plant.hold_piston(true);
  for (int k = 0; k < 60000; ++k) plant.step(0.0);
  CHECK(low(plant.chamber_pressure()) == Approx(101325.0).epsilon(1e-3));
  CHECK(high(plant.chamber_pressure()) == Approx(300e3).epsilon(1e-3));
}

TEST_CASE("plant: a piston that leaks about one place leaks there, less beside it and not afar") {
  AxisParameters<double> axis = nominal_axis();
  axis.effects.piston_leak_zone = {1e-7, 0.02, 0.01};
  const auto lost = [&](double position_m) {
    AxisPlant<double> plant;
    plant.configure(axis, 1e-3, 1.0);
    plant.reset({position_m, 600e3, 300e3});
    plant.hold_piston(true);
    const double before = mass_of(plant, 0);
    plant.step(0.0);
    return before - mass_of(plant, 0);
  };
  const double whole = 1e-3 * orifice_mass_flow(Air<double>{}, 1e-7, 0.35, 600e3, 293.0, 300e3, 293.0);
  CHECK(lost(0.02) == Approx(whole).epsilon(1e-3));
  CHECK(lost(0.03) == Approx(whole * std::exp(-1.0)).epsilon(1e-3));
  CHECK(lost(-0.05) == Approx(0.0).margin(1e-9 * whole));
}

TEST_CASE("plant: at the balancing pressure it rests for ever, exactly where it was put") {
  AxisPlant<double> plant;
  const auto axis = nominal_axis();
  plant.configure(axis, 1e-3, 1.0);
  plant.reset({0.03, 470e3, balancing_pressure_2(axis, 470e3)});
  for (int k = 0; k < 2000; ++k) plant.step(0.0);
  CHECK(plant.position() == Approx(0.03).margin(1e-12));
}

TEST_CASE("plant: exchanging the sides of a symmetric axis mirrors the motion") {
  AxisParameters<double> axis = nominal_axis();
  axis.cylinder.area_2_m2 = axis.cylinder.area_1_m2;
  AxisPlant<double> a, b;
  a.configure(axis, 1e-3, 1.0);
  b.configure(axis, 1e-3, 1.0);
  a.reset({0.02, 450e3, 470e3});
  b.reset({-0.02, 470e3, 450e3});
  for (int k = 0; k < 2000; ++k) {
    const double u = 3.0 * std::sin(0.01 * k);
    a.step(u);
    b.step(-u);
  }
  CHECK(std::fabs(a.position()) > 1e-3);
  CHECK(a.position() == Approx(-b.position()).margin(1e-9));
  CHECK(low(a.chamber_pressure()) == Approx(high(b.chamber_pressure())).epsilon(1e-9));
}

TEST_CASE("plant: supply droop lowers the supply while air is taken and lets it come back") {
  AxisParameters<double> axis = nominal_axis();
  axis.effects.supply_droop = {5e-6, 1e-3};
  AxisPlant<double> plant;
  plant.configure(axis, 1e-3, 1.0);
  plant.reset({0.0, 300e3, 300e3});
  for (int k = 0; k < 100; ++k) plant.step(5.0);
  CHECK(plant.supply_pressure() < 690e3);
  for (int k = 0; k < 5000; ++k) plant.step(0.0);
  CHECK(plant.supply_pressure() == Approx(700e3).epsilon(1e-3));
}

TEST_CASE("plant: a supply that swings does so from the start on, and feeds what droops") {
  AxisParameters<double> axis = nominal_axis();
  axis.effects.supply_swing = {20e3, 3.0, 0.7};
  AxisPlant<double> plant;
  plant.configure(axis, 1e-3, 1.0);
  plant.reset({0.0, 470e3, 470e3});
  for (int k = 0; k < 500; ++k) {
    CHECK(plant.supply_pressure() == Approx(700e3 + 20e3 * std::sin(2 * M_PI * 3.0 * 1e-3 * k + 0.7)).epsilon(1e-9));
    plant.step(0.0);
  }
  axis.effects.supply_droop = {5e-5, 1e-3};
  plant.configure(axis, 1e-3, 1.0);
  plant.reset({0.0, 470e3, 470e3});
  double largest = 0.0, smallest = 1e9;
  for (int k = 0; k < 2000; ++k) {
    plant.step(0.0);
    if (k < 1000) continue;
    largest = std::max(largest, plant.supply_pressure());
    smallest = std::min(smallest, plant.supply_pressure());
  }
  // The volume follows the swing, less than wholly.
  CHECK((largest > 708e3 && largest < 720e3));
  CHECK((smallest < 692e3 && smallest > 680e3));
}

TEST_CASE("plant: the coupling of slider and gas springs neither feeds nor eats the oscillation") {
  // No losses but the lines' small ones: the swing after many periods must not depend on the sub-step.
  AxisParameters<double> axis = nominal_axis(0.01, 5e-5);  // a line without gas to speak of
  axis.cylinder.wall_heat_W_per_m2K = 0.0;
  axis.slider.viscous_friction_Ns_per_m = 0.0;
  AxisPlant<double> plant;
  plant.configure(axis, 1e-3, 1.0);  // a single cell of 10 mm: 30 to 60 sub-steps
  plant.reset({0.0, 470e3, balancing_pressure_2(axis, 470e3)});
  plant.slider().reset(1e-3, 0.0);
  double first = 0.0, last = 0.0;
  for (int k = 0; k < 20000; ++k) {
    plant.step(0.0);
    if (k < 200) first = std::max(first, std::fabs(plant.position()));
    if (k >= 19800) last = std::max(last, std::fabs(plant.position()));
  }
  CHECK(last == Approx(first).epsilon(0.01));
}

namespace {
AxisParameters<double> lagged_table(double frequency_Hz, double damping) {
  AxisParameters<double> axis = nominal_axis();
  axis.supply.pressure_Pa = 251.3e3;
  axis.valve = {1.6, 3.1226e-6, 5e-6, 0.4};
  axis.cylinder = {0.14, 1.2e-3, 1.2e-3, 1.08e-4, 1.08e-4, 50.0};
  for (auto* line : {&axis.line_1, &axis.line_2}) {
    line->model = LineModel::second_order_lag;
    line->natural_frequency_Hz = frequency_Hz;
    line->damping_ratio = damping;
  }
  return axis;
}
}  // namespace

TEST_CASE("plant: a line as a second-order lag passes a choked step of flow as the closed form says") {
  const double f = 40.0, zeta = 0.07, w = 2.0 * M_PI * f, period = 2e-4;
  AxisPlant<double> plant;
  plant.configure(lagged_table(f, zeta), period, 1.0, ValveArrangement::three_port_pair);
  plant.reset({0.0, 80e3, 80e3});  // below 0.4 times the supply: the flow does not see the chamber
  plant.hold_piston(true);
  const double m_0 = lane(plant.sides().chamber().mass(), 0);
  const double flow = orifice_mass_flow(Air<double>{}, 3.1226e-7, 0.4, 251.3e3, 293.0, 80e3, 293.0);
  for (int k = 1; k <= 60; ++k) {
    plant.step(0.1, 0.0);
    const double t = k * period, d = w * std::sqrt(1.0 - zeta * zeta);
    // Integral of the step response 1 - e^(-zeta w t)(cos d t + zeta w/d sin d t).
    const double decay = std::exp(-zeta * w * t);
    const double passed = t - 2.0 * zeta / w +
                          decay * (2.0 * zeta / w * std::cos(d * t) + (2.0 * zeta * zeta - 1.0) / d * std::sin(d * t));
    CHECK(lane(plant.sides().chamber().mass(), 0) - m_0 == Approx(flow * passed).margin(2e-4 * flow * t));
    CHECK(lane(plant.port_pressure(), 0) == lane(plant.chamber_pressure(), 0));
  }
  CHECK(lane(plant.sides().chamber().mass(), 1) == Approx(m_0).epsilon(1e-15));
}

TEST_CASE("plant: each three-port valve obeys its own command") {
  AxisParameters<double> axis = lagged_table(100.0, 0.7);
  for (auto* line : {&axis.line_1, &axis.line_2}) *line = {0.5, 0.004};
  AxisPlant<double> plant;
  plant.configure(axis, 2e-4, 16.0, ValveArrangement::three_port_pair);
  plant.reset({0.0, 140e3, 140e3});
  for (int k = 0; k < 500; ++k) plant.step(0.2, 0.2);  // both fill: the slider stays, both pressures rise
  CHECK(plant.position() == Approx(0.0).margin(1e-15));
  CHECK(low(plant.chamber_pressure()) > 155e3);
  CHECK(low(plant.chamber_pressure()) == high(plant.chamber_pressure()));
  for (int k = 0; k < 500; ++k) plant.step(0.1, -0.1);
  CHECK(plant.position() > 1e-4);
}
