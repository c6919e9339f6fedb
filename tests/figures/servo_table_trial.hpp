// The servo table's plant under the flatness law, closed without the loop: what the law believes may differ from what
// the plant is.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <pneuservo/control/flatness_law.hpp>
#include <pneuservo/control/motion_observer.hpp>
#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/sensor.hpp>
#include <pneuservo/rig/plant.hpp>

#include "control/table_axis.hpp"

namespace pneuservo::figures {

/// The moves of the servo table's figures, 100 mm from -50 mm unless said.
inline ReferenceSpec table_move(double way_m = 0.1, double ramp_s = 0.156) {
  ReferenceSpec spec;
  spec.kind = ReferenceKind::cruise;
  spec.start_m = -0.5 * way_m;
  spec.end_m = 0.5 * way_m;
  spec.speed_mps = 0.0597;
  spec.ramp_s = ramp_s;
  spec.start_s = 0.2;
  spec.smoothness = 9;
  return spec;
}
/// Slow polynomial of degree 9, 39.8 s per metre.
inline ReferenceSpec gentle_move(double way_m = 0.1) {
  ReferenceSpec spec;
  spec.kind = ReferenceKind::waypoints;
  spec.times_s = {0.2, 0.2 + 39.8 * way_m};
  spec.positions_m = {-0.5 * way_m, 0.5 * way_m};
  spec.smoothness = 9;
  return spec;
}

struct TableTrial {
  AxisParameters<double> believed, real;
  ReferenceSpec reference;
  FlatnessSettings plan;
  Ppd2Gains gains;
  LinearServoTable linear_model;
  int linear_order = 0;         ///< 3, 5, 7: inverse of the linear model to valve 1, the opposite to valve 2
  double valve_2_factor = 1.0;  ///< areas of the real valve 2 over those of valve 1
  double integral_gain_V_per_m_s = 0.0;
  double cells_per_m = 64.0;    ///< of the plant
  int refine = 1;               ///< plant periods a tick
  double port_noise_Pa = 0.0, port_quantum_Pa = 0.0;
  double command_quantum_V = 0.0;
  double scale_quantum_m = 62.5e-12;
  double leak_1_m2 = 0.0, leak_at_s = 0.0;  ///< chamber 1 to atmosphere, from then on
  double start_deviation_Pa = 0.0;  ///< both chambers at the start, beside the mean pressure of the plan
  double hold_rad_per_s = 2.0;
  double after_s = 0.6;             ///< the error counts from 0 to this long after the move
  std::uint64_t seed = 1;

  TableTrial(const test::TableCase& one, const ReferenceSpec& spec, double mean_pressure_Pa)
      : believed(test::table_axis(one)), real(believed), reference(spec), gains(one.gains_5),
        linear_model(test::nominal_linear_table(one)) {
    plan.mean_pressure_Pa = mean_pressure_Pa;
  }
};

struct TableOutcome {
  double max_error_m = 0.0, end_error_m = 0.0;  ///< end: mean of the last 0.1 s
  double largest_command_V = 0.0, mean_pressure_Pa = 0.0;
};

/// Runs moves one after another, each from rest at the start; the law keeps what it has learned.
class TableRunner {
 public:
  explicit TableRunner(const TableTrial& trial)
      : trial_(trial), reference_(trial.reference),
        linear_inverse_(inverse_coefficients(trial.linear_model, trial.linear_order)),
        law_(FlatnessPlan(trial.believed, reference_, reference_.end_s() + trial.after_s, trial.plan),
             flatness_gains(trial.believed, 110e3, trial.hold_rad_per_s), trial.plan.period_s) {}

  TableOutcome move() {
    const double period_s = trial_.plan.period_s;
    AxisPlant<double> plant;
    start(plant);
    MotionObserver observer;
    observer.configure(ObserverGains::butterworth(1000.0), period_s);
    Random noise(trial_.seed, ++moves_);
    law_.reset();
    TableOutcome out;
    double integral = 0.0, last_sum = 0.0;
    const auto ticks = std::llround((reference_.end_s() + trial_.after_s) / period_s);
    const auto last = std::llround(0.1 / period_s);
    for (std::int64_t k = 0; k < ticks; ++k) {
      const double x_ref = reference_.at(static_cast<double>(k) * period_s).d[0], error = plant.position() - x_ref;
      out.max_error_m = std::max(out.max_error_m, std::fabs(error));
      if (k >= ticks - last) last_sum += error;
      const double measured_error = quantise(plant.position(), trial_.scale_quantum_m) - x_ref;
      observer.step(measured_error);
      const double feedback = -trial_.gains.position_V_per_m * observer.position_m() -
                              trial_.gains.velocity_Vs_per_m * observer.velocity_mps() -
                              trial_.gains.acceleration_Vs2_per_m * observer.acceleration_mps2() + integral;
      const auto port = plant.port_pressure();
      const auto measured = [&](double p) {
        return quantise(p + trial_.port_noise_Pa * noise.normal(), trial_.port_quantum_Pa);
      };
      const double p1 = measured(low(port)), p2 = measured(high(port));
      const FlatnessCommand u =
          trial_.linear_order > 0 ? linear(k, feedback) : law_.step(k, measured_error, feedback, p1, p2);
      const double range = trial_.believed.valve.command_max_V;
      const double largest = std::max(std::fabs(u.valve_1_V), std::fabs(u.valve_2_V));
      out.largest_command_V = std::max(out.largest_command_V, largest);
      if (largest < range) integral -= trial_.integral_gain_V_per_m_s * observer.position_m() * period_s;
      for (int i = 0; i < trial_.refine; ++i)
        plant.step(quantise(u.valve_1_V, trial_.command_quantum_V), quantise(u.valve_2_V, trial_.command_quantum_V));
    }
    out.end_error_m = last_sum / static_cast<double>(last);
    out.mean_pressure_Pa = 0.5 * (low(plant.chamber_pressure()) + high(plant.chamber_pressure()));
    return out;
  }
  FlatnessLaw& law() { return law_; }
  const TableTrial& trial() const { return trial_; }

 private:
  FlatnessCommand linear(std::int64_t k, double feedback_V) const {
    const auto d = reference_.at((static_cast<double>(k) + 0.5) * trial_.plan.period_s).d;
    double u = feedback_V;
    for (std::size_t i = 1; i < 8; ++i) u += linear_inverse_[i] * d[i];
    return {u, -u};
  }
  void start(AxisPlant<double>& plant) const {
    const double period_s = trial_.plan.period_s / trial_.refine;
    plant.configure(trial_.real, period_s, trial_.cells_per_m, ValveArrangement::three_port_pair);
    using P = Pair<double>;
    ValveParameters<P> valves{};
    ValveParameters<P>::visit([](const Field&, auto& to, const auto& from) { to = join(from, from); }, valves,
                              trial_.real.valve);
    valves.area_per_volt_m2_per_V = valves.area_per_volt_m2_per_V * join(1.0, trial_.valve_2_factor);
    plant.valves().pair().configure(valves, {}, period_s);
    const double p = trial_.plan.mean_pressure_Pa + trial_.start_deviation_Pa;
    plant.reset({reference_.at(0.0).d[0], p, p});
  }

  TableTrial trial_;
  Reference reference_;
  std::array<double, 8> linear_inverse_{};
  FlatnessLaw law_;
  std::uint64_t moves_ = 0;
};

}  // namespace pneuservo::figures
