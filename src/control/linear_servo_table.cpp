// Constants and inverse of the servo table's linear models.
#include <cmath>

#include <pneuservo/control/linear_servo_table.hpp>
#include <pneuservo/elements/air.hpp>
#include <pneuservo/rig/axis.hpp>

namespace pneuservo {

LinearServoTable linear_servo_table(const AxisParameters<double>& axis, double equilibrium_pressure_Pa,
                                    const SecondOrderLag& line) noexcept {
  constexpr double rad_per_cycle = 6.283185307179586;
  const auto& cylinder = axis.cylinder;
  const double area_m2 = 0.5 * (cylinder.area_1_m2 + cylinder.area_2_m2);
  const double volume_m3 = 0.5 * (cylinder.dead_volume_1_m3 + cylinder.dead_volume_2_m3 + area_m2 * cylinder.stroke_m);
  const double mass_kg = axis.slider.mass_kg + axis.slider.payload_kg;
  const double supply_Pa = axis.supply.pressure_Pa, critical = axis.valve.critical_pressure_ratio;
  const Air<double> air(axis.air);

  LinearServoTable table;
  const double beyond =
      std::fmax(0.0, (axis.air.atmosphere_Pa / equilibrium_pressure_Pa - critical) / (1.0 - critical));
  table.discharge_ratio = std::sqrt(1.0 - beyond * beyond) * equilibrium_pressure_Pa / supply_Pa;
  table.natural_frequency_squared = 2.0 * area_m2 * area_m2 * equilibrium_pressure_Pa / (mass_kg * volume_m3);
  const double speed_per_area = (1.0 + table.discharge_ratio) * air.flow_constant * supply_Pa *
                                std::sqrt(axis.air.gas_constant_J_per_kgK * axis.air.temperature_K) /
                                (2.0 * area_m2 * equilibrium_pressure_Pa);  // K_n
  table.gain_per_V = speed_per_area * axis.valve.area_per_volt_m2_per_V * table.natural_frequency_squared;
  table.line = line;
  table.valve = {rad_per_cycle * axis.valve.natural_frequency_Hz, axis.valve.damping_ratio};
  return table;
}

SecondOrderLag low_frequency_match(const SecondOrderLag& first, const SecondOrderLag& second) noexcept {
  const double a1 = first.slope_s() + second.slope_s();
  const double a2 = first.curvature_s2() + second.curvature_s2() + first.slope_s() * second.slope_s();
  if (!(a2 > 0.0)) return {};
  const double frequency = 1.0 / std::sqrt(a2);
  return {frequency, 0.5 * a1 * frequency};
}

std::array<double, 8> inverse_coefficients(const LinearServoTable& table, int order) noexcept {
  std::array<double, 8> a{};
  if (order != 3 && order != 5 && order != 7) return a;
  a[1] = table.natural_frequency_squared / table.gain_per_V;
  a[3] = 1.0 / table.gain_per_V;
  const auto behind = [&](const SecondOrderLag& lag) {  // times 1 + slope s + curvature s^2
    for (std::size_t i = 7; i >= 1; --i)
      a[i] += lag.slope_s() * a[i - 1] + (i >= 2 ? lag.curvature_s2() * a[i - 2] : 0.0);
  };
  if (order == 5) behind(low_frequency_match(table.line, table.valve));
  if (order == 7) {
    behind(table.line);
    behind(table.valve);
  }
  return a;
}

std::array<double, 8> feedforward_coefficients(const LinearServoTable& table, const Ppd2Gains& gains,
                                               int order) noexcept {
  std::array<double, 8> c = inverse_coefficients(table, order);
  c[0] += gains.position_V_per_m;
  c[1] += gains.velocity_Vs_per_m;
  c[2] += gains.acceleration_Vs2_per_m;
  for (double& value : c) value /= gains.position_V_per_m;
  return c;
}

}  // namespace pneuservo
