// The nominal servo table (chapter 2) with the two lines of the thesis, for tests.
#pragma once
#include <pneuservo/control/linear_servo_table.hpp>

#include "rig/nominal_axis.hpp"

namespace pneuservo::test {

inline constexpr double cycle_rad = 6.283185307179586;

/// One of the thesis' two lines, with its printed lag (the swap of table 2.8 undone) and its printed gains x 1000.
struct TableCase {
  const char* name;
  double length_m, diameter_m;
  SecondOrderLag line;
  Ppd2Gains gains_3, gains_5;
};
inline constexpr TableCase table_4mm{
    "4 mm", 0.5, 0.004, {cycle_rad * 110.0, 0.068}, {1200, 62.1, 1.67}, {1200, 54.0, 1.30}};
inline constexpr TableCase table_8mm{
    "8 mm", 1.0, 0.008, {cycle_rad * 102.0, 0.048}, {1500, 72.3, 1.79}, {1500, 60.0, 1.80}};

/// What the table has beside the cylinder's axis: another valve with a spool of its own, equal sides, no friction.
inline AxisParameters<double> table_axis(const TableCase& one) {
  AxisParameters<double> axis = nominal_axis(one.length_m, one.diameter_m);
  axis.supply.pressure_Pa = 251.3e3;
  axis.valve = {.command_max_V = 1.6,
                .area_per_volt_m2_per_V = 3.1226e-6,
                .area_max_m2 = 5.0e-6,
                .critical_pressure_ratio = 0.4,
                .natural_frequency_Hz = 100.0,
                .damping_ratio = 0.7};
  axis.cylinder.stroke_m = 0.140;
  axis.cylinder.area_1_m2 = axis.cylinder.area_2_m2 = 1.2e-3;
  axis.cylinder.dead_volume_1_m3 = axis.cylinder.dead_volume_2_m3 = 1.08e-4;
  axis.slider.mass_kg = 26.0;
  axis.slider.viscous_friction_Ns_per_m = 0.0;
  return axis;
}

/// The linear model of the note: 110 kPa, K = 45.580 m/(s3 V) to all digits.
inline LinearServoTable nominal_linear_table(const TableCase& one) {
  LinearServoTable table = linear_servo_table(table_axis(one), 110e3, one.line);
  table.gain_per_V = 45.580;
  return table;
}

}  // namespace pneuservo::test
