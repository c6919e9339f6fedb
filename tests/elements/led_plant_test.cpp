// The axis with its motion given from outside: the same gas as when it moves by itself, a wrong start forgotten, lanes
// free of each other; the valve's path resolved within a sub-step.
#include <catch2/catch.hpp>

#include <vector>

#include <pneuservo/rig/plant.hpp>

#include "rig/nominal_axis.hpp"

using namespace pneuservo;

namespace {
AxisParameters<double> led_axis() { return test::nominal_axis(5.0, 6.1e-3); }
double command_at(int k) { return 1.0 * std::sin(0.01 * k) + 0.1 * std::sin(0.07 * k); }

/// A free run and its positions at the period's ends.
struct FreeRun {
  FreeRun() {
    plant.configure(led_axis(), 1e-3, PlantGrid{20, 4});
    plant.reset({0.0, 470e3, balancing_pressure_2(led_axis(), 470e3)});
    for (int k = 0; k < 3000; ++k) {
      plant.step(command_at(k));
      position.push_back(plant.position());
    }
  }
  AxisPlant<double> plant;
  std::vector<double> position;
};

/// What is led along a free run after starting from a gas wrong by a factor of its mass on side 1.
template <class S> AxisPlant<S> led_along(const FreeRun& free, double factor, const AxisParameters<S>& axis) {
  AxisPlant<S> plant;
  plant.configure(axis, 1e-3, PlantGrid{20, 4});
  plant.reset({S(0), S(470e3), S(balancing_pressure_2(led_axis(), 470e3))});
  plant.scale_gas(join(S(factor), S(1)), join(S(1), S(1)));
  for (int k = 0; k < 3000; ++k)
    plant.step_led(S(command_at(k)), S(-command_at(k)), S(free.position[static_cast<std::size_t>(k)]));
  return plant;
}
}  // namespace

TEST_CASE("led plant: along the motion of a free run the pressures are the free run's") {
  const FreeRun free;
  const auto led = led_along<double>(free, 1.0, led_axis());
  CHECK(lane(led.chamber_pressure(), 0) == Approx(lane(free.plant.chamber_pressure(), 0)).margin(100.0));
  CHECK(lane(led.chamber_pressure(), 1) == Approx(lane(free.plant.chamber_pressure(), 1)).margin(100.0));
  CHECK(lane(led.port_pressure(), 0) == Approx(lane(free.plant.port_pressure(), 0)).margin(100.0));
}

TEST_CASE("led plant: with the valve at work a wrong start of the gas is forgotten") {
  const FreeRun free;
  const auto right = led_along<double>(free, 1.0, led_axis()), wrong = led_along<double>(free, 1.05, led_axis());
  const double start = 0.05 * 470e3, end = lane(wrong.chamber_pressure(), 0) - lane(right.chamber_pressure(), 0);
  CHECK(std::fabs(end) < 0.1 * start);
}

TEST_CASE("led plant: scaled gas has the mass of its pressure and temperature, and cools to the wall") {
  AxisPlant<double> plant;
  plant.configure(led_axis(), 1e-3, PlantGrid{20, 4});
  plant.reset({0.02, 450e3, 480e3});
  const double chamber_kg = lane(plant.sides().chamber().mass(), 1);
  const auto line_kg = plant.sides().line().mass();
  plant.scale_gas(join(1.01, 1.0), join(1.0, 1.02));
  CHECK(lane(plant.chamber_pressure(), 0) == Approx(1.01 * 450e3));
  CHECK(lane(plant.port_pressure(), 0) == Approx(1.01 * 450e3));
  CHECK(lane(plant.sides().line().mass(), 0) == Approx(1.01 * lane(line_kg, 0)));
  CHECK(lane(plant.chamber_pressure(), 1) == 480e3);
  CHECK(lane(plant.sides().chamber().temperature(), 1) == Approx(1.02 * 293.0));
  CHECK(lane(plant.sides().line().cell_temperature(7), 1) == Approx(1.02 * 293.0));
  CHECK(lane(plant.sides().chamber().mass(), 1) == Approx(chamber_kg / 1.02));
  CHECK(lane(plant.sides().line().mass(), 1) == Approx(lane(line_kg, 1) / 1.02));
  for (int k = 0; k < 3000; ++k) plant.step_led(0.0, 0.0, 0.02);  // shut in
  CHECK(lane(plant.chamber_pressure(), 0) == Approx(1.01 * 450e3).margin(300.0));
  CHECK(lane(plant.chamber_pressure(), 1) == Approx(480e3 / 1.02).epsilon(2e-3));
  CHECK(plant.position() == 0.02);
}

TEST_CASE("led plant: a lane does not see its neighbours, whatever effects they have") {
  const FreeRun free;
  auto odd = led_axis();
  odd.effects.valve.command_delay.delay_s = 4e-4;
  odd.effects.valve.valve_lag.time_constant_s = 3e-3;
  odd.effects.valve.valve_hysteresis.width_V = 0.02;
  odd.effects.line_restriction_1.area_m2 = 8e-6;
  odd.effects.line_leak_2 = {5e-9, 0.5};
  odd.effects.supply_droop = {4e-6, 1e-3};
  auto axis = cast<AxisParameters<Pack<double, 4>>>(led_axis());
  set_parameters_lane(axis, 1, odd);
  const auto lanes = led_along<Pack<double, 4>>(free, 1.0, axis);
  const auto plain = led_along<double>(free, 1.0, led_axis()), alone = led_along<double>(free, 1.0, odd);
  for (int side = 0; side < 2; ++side) {
    CHECK(lane(lanes.chamber_pressure(), 4 * side) == lane(plain.chamber_pressure(), side));
    CHECK(lane(lanes.chamber_pressure(), 4 * side + 1) == lane(alone.chamber_pressure(), side));
    CHECK(lane(lanes.port_pressure(), 4 * side + 1) == lane(alone.port_pressure(), side));
  }
}

TEST_CASE("valve: within one sub-step the mean area has the delay's and the lag's share") {
  const auto mean_area = [](double delay_s, double lag_s) {
    ValveEffects<double> effects;
    effects.command_delay.delay_s = delay_s;
    effects.valve_lag.time_constant_s = lag_s;
    Valve<double> valve;
    valve.configure({5.0, 1e-6, 1e-5, 0.35, 0.0, 0.7}, effects, 1e-3);
    valve.set_time_step(1e-3);
    valve.set_command(1.0);
    return valve.step(0.0).supply / 1e-6;
  };
  CHECK(mean_area(0.0, 0.0) == 1.0);
  for (const double delay : {0.2e-3, 0.5e-3, 0.9e-3})
    CHECK(mean_area(delay, 0.0) == Approx(1.0 - delay / 1e-3).margin(0.13));
  for (const double tau : {0.5e-3, 2e-3})
    CHECK(mean_area(0.0, tau) == Approx(1.0 - tau / 1e-3 * (1.0 - std::exp(-1e-3 / tau))).epsilon(0.02));
}
