// The printed moves on the linear plant behind a hold, by the law and by ideal derivatives.
#pragma once
#include <pneuservo/control/ppd2.hpp>

#include "control/linear_trial.hpp"
#include "control/table_axis.hpp"

namespace pneuservo::test {

inline constexpr double table_period_s = 2e-4;

inline Reference printed_move(double way_m = 0.1) {
  ReferenceSpec spec;
  spec.kind = ReferenceKind::cruise;
  spec.start_m = -0.5 * way_m;
  spec.end_m = 0.5 * way_m;
  spec.speed_mps = 0.0597;
  spec.ramp_s = 0.156;
  spec.smoothness = 9;
  return Reference(spec);
}

/// u = Kp (r - x) - Kv v - Ka a on the plant's own state; order 0: r is x_ref. Error in um.
inline double with_ideal_derivatives_um(const TableCase& one, const Ppd2Gains& g, int order, double way_m = 0.1) {
  const LinearServoTable table = nominal_linear_table(one);
  const auto c = feedforward_coefficients(table, g, order == 0 ? 3 : order);
  const Reference reference = printed_move(way_m);
  return 1e6 * linear_trial_error_m(table, reference, table_period_s, [&](double t_s, const LinearTablePlant& plant) {
           const ReferencePoint r = reference.at(t_s);
           double aim = r.d[0];
           for (std::size_t i = 1; i < 8 && order != 0; ++i) aim += c[i] * r.d[i];
           return g.position_V_per_m * (aim - plant.position_m()) - g.velocity_Vs_per_m * plant.velocity_mps() -
                  g.acceleration_Vs2_per_m * plant.acceleration_mps2();
         });
}

struct LawCase {
  FeedforwardKind feedforward;
  ObserverInput observer;
  double observer_rad_per_s;  // 0: the printed gains
  bool shift;                 // false: the feedforward of t_k, as printed
};
inline constexpr double printed_observer = 0.0;

/// The law itself on the plant. Error in um.
inline double with_law_um(const TableCase& one, const Ppd2Gains& g, const LawCase& law, double way_m = 0.1) {
  Ppd2Parameters p;
  p.position_gain_V_per_m = g.position_V_per_m;
  p.velocity_gain_Vs_per_m = g.velocity_Vs_per_m;
  p.acceleration_gain_Vs2_per_m = g.acceleration_Vs2_per_m;
  p.observer = law.observer;
  p.feedforward = law.feedforward;
  if (law.observer_rad_per_s > 0.0) p.observer_rad_per_s = law.observer_rad_per_s;
  else p.observer_gains = {530.5, 140739.9, 1.85e7};
  AxisParameters<double> axis = table_axis(one);
  axis.line_1.natural_frequency_Hz = one.line.natural_frequency_rad_per_s / cycle_rad;
  axis.line_1.damping_ratio = one.line.damping_ratio;
  Ppd2 controller;
  controller.configure(p, axis, table_period_s);
  const Reference reference = printed_move(way_m);
  const LinearServoTable plant = linear_servo_table(axis, p.equilibrium_pressure_Pa, one.line);
  return 1e6 * linear_trial_error_m(plant, reference, table_period_s, [&](double t_s, const LinearTablePlant& state) {
           const ReferencePoint now = reference.at(t_s);
           const ReferencePoint ahead = law.shift ? reference.at(t_s + controller.lead_s()) : now;
           return controller.step({state.position_m(), {}, {}, {}, now, ahead}).command_V[0];
         });
}

}  // namespace pneuservo::test
