// Flatness feedforward in the loop: feedback in flow, hold of the mean pressure, what a finished move teaches
// (docs/physics/flatness.md).
#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <pneuservo/control/flatness_plan.hpp>

namespace pneuservo {

struct FlatnessCommand {
  double valve_1_V = 0.0, valve_2_V = 0.0;
};

/// Constants of the law, from the rig.
struct FlatnessGains {
  double flow_per_volt_kgps = 0.0;  ///< F_g: feedback in volts to flow, so that the loop gain is the linear design's
  double pressure_hold_kgps_per_Pa = 0.0;  ///< k_m = hold_rad_per_s V0/(R theta)
  double pressure_filter_s = 0.05;  ///< of the measured mean port pressure
};

/// F_g = K m V0/(2 A R theta) with K of the linear model at the design's equilibrium pressure (linear_servo_table), k_m
/// for a hold of the mean pressure at hold_rad_per_s. Cold.
FlatnessGains flatness_gains(const AxisParameters<double>& axis, double equilibrium_pressure_Pa,
                             double hold_rad_per_s = 2.0) noexcept;

/// One command a valve: feedforward flow, feedback as a flow of opposite sign in both, hold of the mean pressure, all
/// through the valves at the pressures of the feedforward. It remembers the feedback of a move for learning.
class FlatnessLaw {
 public:
  FlatnessLaw() = default;
  /// Cold; allocates. Forgets what was learned.
  FlatnessLaw(FlatnessPlan plan, const FlatnessGains& gains, double period_s);

  /// Forgets the filtered pressure: the next measured one is taken as it is. HOT.
  void reset() noexcept { filter_started_ = false; }
  /// Commands of tick k of the reference (negative: before it). error_m: e = x - x_ref as measured; feedback_V:
  /// -(K_p e + K_v e_v + K_a e_a) + K_i int(-e) dt; measured port pressures [Pa]. HOT.
  FlatnessCommand step(std::int64_t tick, double error_m, double feedback_V, double port_1_Pa,
                       double port_2_Pa) noexcept;

  /// After a move of this reference: what the feedback added, less the flow that belongs to the error that was left,
  /// joins the feedforward from the next move on. For repeated moves; `axis` is what the plan was made of. A move that
  /// was not recorded to its end teaches nothing. Cold.
  void learn_flow(const AxisParameters<double>& axis);
  /// After a move: re-estimates how much larger the effective area is than the model's, from what was missing in
  /// proportion to the feedforward. For moves that are not repeated. Returns the factor now in use. Cold.
  double learn_area(const AxisParameters<double>& axis);
  double area_factor() const noexcept { return area_factor_; }
  /// Moves that taught nothing because more than 1 % of their ticks were skipped. Not while another thread learns.
  int moves_not_learned() const noexcept { return moves_not_learned_; }
  /// For the plan of another reference: the area stays known, the flow does not. Cold.
  void set_plan(FlatnessPlan plan);
  const FlatnessPlan& plan() const noexcept { return plan_; }

 private:
  FlatnessPlan plan_;
  FlatnessGains gains_;
  double period_s_ = 2e-4, filter_share_ = 1.0;
  double area_factor_ = 1.0;
  double mean_pressure_Pa_ = 0.0;
  bool filter_started_ = false;
  int moves_not_learned_ = 0;
  std::optional<std::vector<double>> take_missing_flow(const AxisParameters<double>& axis);

  std::vector<double> error_m_, feedback_kgps_, learned_kgps_;  // a tick each; NaN: not recorded
};

}  // namespace pneuservo
