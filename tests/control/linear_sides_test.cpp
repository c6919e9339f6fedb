// An axis with the linear flows and chambers of (2.3) to (2.6): closed forms, and the linear table of each order.
#include <cmath>

#include <catch2/catch.hpp>

#include <pneuservo/rig/plant.hpp>

#include "config/read_rig.hpp"
#include "control/linear_trial.hpp"

using namespace pneuservo;

namespace {

constexpr double about_Pa = 110e3, table_period_s = 2e-4;

/// The shipped table, linear, with these lags; frequency 0: none. rad/s in a lag, Hz in the axis.
AxisParameters<double> linear_axis(const SecondOrderLag& valve, const SecondOrderLag& line) {
  constexpr double rad_per_cycle = 6.283185307179586;
  AxisParameters<double> axis = read_rig(PNEUSERVO_SOURCE_DIR "/config/servo-table-0.5m-4mm.yaml").axis;
  axis.cylinder.linear_about_Pa = about_Pa;
  axis.valve.natural_frequency_Hz = valve.natural_frequency_rad_per_s / rad_per_cycle;
  axis.valve.damping_ratio = valve.damping_ratio;
  for (LineParameters<double>* one : {&axis.line_1, &axis.line_2}) {
    one->model = LineModel::second_order_lag;
    one->natural_frequency_Hz = line.natural_frequency_rad_per_s / rad_per_cycle;
    one->damping_ratio = line.damping_ratio;
  }
  return axis;
}

AxisPlant<double> plant_at(const AxisParameters<double>& axis, double position_m, double pressure_Pa) {
  AxisPlant<double> plant;
  plant.configure(axis, table_period_s, 1.0, ValveArrangement::three_port_pair);
  plant.reset({position_m, pressure_Pa, pressure_Pa});
  return plant;
}

}  // namespace

TEST_CASE("linear sides: a held piston's pressures rise and fall by the flows of the equilibrium, whatever they are") {
  const AxisParameters<double> axis = linear_axis({}, {0.0, 0.05});
  const auto& cylinder = axis.cylinder;
  const Air<double> air(axis.air);
  const double volume_m3 = cylinder.dead_volume_1_m3 + 0.5 * cylinder.stroke_m * cylinder.area_1_m2;
  const double RT = air.R * air.temperature_K, command_V = 0.1;
  const double charge_Pa_per_s = RT / volume_m3 * air.flow_constant * axis.supply.pressure_Pa / std::sqrt(RT) *
                                 axis.valve.area_per_volt_m2_per_V * command_V;
  const double delta = linear_servo_table(axis, about_Pa, {}).discharge_ratio;
  for (const double start_Pa : {105e3, 110e3, 180e3}) {
    CAPTURE(start_Pa);
    AxisPlant<double> plant = plant_at(axis, 0.03, start_Pa);
    plant.hold_piston(true);
    for (int k = 0; k < 50; ++k) plant.step(command_V, -command_V);
    const double time_s = 50 * table_period_s;
    CHECK(low(plant.chamber_pressure()) == Approx(start_Pa + charge_Pa_per_s * time_s).epsilon(1e-9));
    CHECK(high(plant.chamber_pressure()) == Approx(start_Pa - delta * charge_Pa_per_s * time_s).epsilon(1e-9));
  }
}

TEST_CASE("linear sides: without a command the slider swings at omega_n about where it stands") {
  const AxisParameters<double> axis = linear_axis({}, {0.0, 0.05});
  const double omega = std::sqrt(linear_servo_table(axis, about_Pa, {}).natural_frequency_squared);
  AxisPlant<double> plant = plant_at(axis, 0.0, about_Pa);
  const double push_Pa = 50.0;
  plant.reset({0.0, about_Pa + push_Pa, about_Pa});
  // Farthest at half a period, by 2 F/(m omega^2).
  const auto half = static_cast<int>(std::lround(M_PI / omega / table_period_s));
  for (int k = 0; k < half; ++k) plant.step(0.0, 0.0);
  const double force_N = axis.cylinder.area_1_m2 * push_Pa;
  CHECK(plant.position() == Approx(2.0 * force_N / (axis.slider.mass_kg * omega * omega)).epsilon(1e-3));
  CHECK(plant.velocity() == Approx(0.0).margin(1e-3 * omega * plant.position()));
}

TEST_CASE("linear sides: the axis moves as the linear table of third, fifth and seventh order") {
  constexpr double rad_per_cycle = 6.283185307179586;
  const SecondOrderLag valve{rad_per_cycle * 100.0, 0.7}, line{rad_per_cycle * 110.0, 0.068}, none{0.0, 0.05};
  struct Order {
    int order;
    SecondOrderLag valve, line;
  };
  for (const Order& one :
       {Order{3, none, none}, Order{5, none, low_frequency_match(line, valve)}, Order{7, valve, line}}) {
    CAPTURE(one.order);
    const AxisParameters<double> axis = linear_axis(one.valve, one.line);
    AxisPlant<double> plant = plant_at(axis, -0.02, about_Pa);
    LinearServoTable table = linear_servo_table(axis, about_Pa, one.line);
    table.valve = one.valve;
    LinearTablePlant exact(table, table_period_s);
    exact.reset(-0.02);
    double apart_m = 0.0, way_m = 0.0;
    for (int k = 0; k < 2500; ++k) {
      const double t = k * table_period_s, u = 0.02 * std::sin(30.0 * t) + 0.01 * std::sin(400.0 * t);
      plant.step(u, -u);
      exact.step(u);
      apart_m = std::max(apart_m, std::fabs(plant.position() - exact.position_m()));
      way_m = std::max(way_m, std::fabs(exact.position_m() + 0.02));
    }
    CHECK(way_m > 1e-4);
    CHECK(apart_m < 2e-3 * way_m);
  }
}
