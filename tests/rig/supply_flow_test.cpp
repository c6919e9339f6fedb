// What the plant takes from its supply: at rest what leaks away, over a stroke what both sides have gained and let go.
#include <catch2/catch.hpp>

#include <cmath>

#include <pneuservo/rig/plant.hpp>

#include "rig/nominal_axis.hpp"

using namespace pneuservo;

namespace {

constexpr double flow_period_s = 1e-3;

AxisPlant<double> plant_of(const AxisParameters<double>& axis) {
  AxisPlant<double> plant;
  plant.configure(axis, flow_period_s, 4.0);
  plant.reset({0.0, 4.7e5, 4.7e5});
  return plant;
}

double taken_kgps(const AxisPlant<double>& plant) { return true_values(plant)[Signal::supply_flow]; }

}  // namespace

TEST_CASE("supply flow: at rest under pressure it is the flow of the leak") {
  AxisParameters<double> axis = test::nominal_axis();
  axis.effects.chamber_leak_1.area_m2 = 6.5e-9;
  AxisPlant<double> plant = plant_of(axis);
  for (int k = 0; k < 20'000; ++k) plant.step(1.0);  // to the end stop, side 1 full
  const Air<double> air(axis.air);
  const double leak_kgps =
      orifice_mass_flow(air, axis.effects.chamber_leak_1.area_m2, axis.valve.critical_pressure_ratio,
                        low(plant.chamber_pressure()), air.temperature_K, air.atmosphere_Pa, air.temperature_K);
  CHECK(taken_kgps(plant) == Approx(leak_kgps).epsilon(0.01));
  CHECK(leak_kgps / (101325.0 / (air.R * 273.15)) * 60e3 == Approx(0.5).epsilon(0.03));  // normal litres a minute
}

TEST_CASE("supply flow: without a leak nothing is taken at rest, and a closed valve takes nothing") {
  AxisPlant<double> plant = plant_of(test::nominal_axis());
  plant.step(0.0);
  CHECK(taken_kgps(plant) == 0.0);
  for (int k = 0; k < 20'000; ++k) plant.step(1.0);
  CHECK(std::abs(taken_kgps(plant)) < 1e-8);
}
