// PD with force feedback (chapter 3): position and velocity errors ask for a force, pressures close the force loop.
#pragma once
#include <cstdint>

#include <pneuservo/control/flow_feedforward.hpp>
#include <pneuservo/control/limits.hpp>
#include <pneuservo/control/parameters.hpp>
#include <pneuservo/control/reference.hpp>

namespace pneuservo {

/// Bits of PdForceState::fault.
enum ControllerFault : std::uint8_t {
  controller_healthy = 0,
  controller_command_not_finite = 1,  ///< an input or gain made the command NaN or infinite; the last command was kept
};

/// Every term of the law at the last step, as it can be recorded.
struct PdForceState {
  double e_m = 0.0;  ///< x_ref - x
  double v_mps = 0.0;  ///< filtered velocity
  double F_N = 0.0;  ///< force of the chambers on the piston
  double F_ref_N = 0.0;  ///< force asked for
  double e_F_N = 0.0;  ///< F_ref - F
  double I_Ns = 0.0;  ///< integral of e_F
  double u_feedforward_V = 0.0;
  double u_unlimited_V = 0.0;  ///< command before range and rate
  double u_V = 0.0;  ///< command
  std::uint8_t limit = limit_none;  ///< CommandLimit that acted
  std::uint8_t fault = controller_healthy;  ///< ControllerFault bits
};

/// The controller of docs/physics/pd_force.md. Plain data; copying it copies its whole state.
class PdForce {
 public:
  PdForce() noexcept = default;
  PdForce(const PdForceParameters& parameters, const AxisParameters<double>& axis, double period_s) noexcept {
    configure(parameters, axis, period_s);
  }
  /// Cold: takes parameters (in the ranges of their fields), period_s > 0, and resets.
  void configure(const PdForceParameters& parameters, const AxisParameters<double>& axis, double period_s) noexcept;
  /// Forgets velocity and integral; the command's rate counts from previous_command_V. HOT.
  void reset(double previous_command_V = 0.0) noexcept;
  /// Bumpless start at the measured position and pressures: the velocity starts at 0 and the integral (if there is
  /// one) such that a step with these inputs gives command_V. HOT.
  void start_bumpless(double x_m, double p1_Pa, double p2_Pa, const ReferencePoint& now, const ReferencePoint& ahead,
                      double command_V) noexcept;

  /// Command [V] of one period from measured position [m], the pressures that pressure_source names [Pa, absolute], the
  /// reference at t and at t + lead_s(). Always finite; HOT.
  double step(double x_m, double p1_Pa, double p2_Pa, const ReferencePoint& now, const ReferencePoint& ahead) noexcept;

  /// Periods passed without a step (a late loop skipped its slots): the next velocity counts over all of them. HOT.
  void skip(std::int64_t periods) noexcept { periods_ += static_cast<double>(periods); }

  const PdForceState& state() const noexcept { return state_; }
  /// How far ahead of t the second reference point of a step lies [s]; 0 without flow feedforward.
  double lead_s() const noexcept { return parameters_.flow_feedforward ? parameters_.feedforward_lead_s : 0.0; }

 private:
  PdForceState terms(double x_m, double p1_Pa, double p2_Pa, const ReferencePoint& now,
                     const ReferencePoint& ahead) const noexcept;
  double unlimited_V(const PdForceState& s) const noexcept {
    return parameters_.force_gain_V_per_N * s.e_F_N + parameters_.force_integral_V_per_Ns * s.I_Ns + s.u_feedforward_V;
  }

  PdForceParameters parameters_{};
  FlowFeedforward feedforward_{};
  CommandLimiter limiter_{};
  PdForceState state_{};
  double period_s_ = 0.001, filter_gain_ = 1.0;
  double area_1_m2_ = 0.0, area_2_m2_ = 0.0, atmosphere_force_N_ = 0.0;
  double previous_x_m_ = 0.0, periods_ = 1.0;  ///< last good position and its age
  bool first_ = true;
};

}  // namespace pneuservo
