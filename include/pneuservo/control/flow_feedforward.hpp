// Flow feedforward: the valve area that gives the force rate a reference asks for (docs/physics/pd_force.md).
#pragma once
#include <array>
#include <cmath>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/core/pack.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/pipe_friction.hpp>

namespace pneuservo {

template <class S> struct AxisParameters;

/// Polytropic exponent of chamber and line while the axis moves.
inline constexpr double feedforward_polytropic_exponent = 1.3;

/// What the steady pressure loss of a line needs, computed once.
template <class S> struct SteadyLine {
  S reynolds_per_flow = S(0);  ///< Re = this |G|, s/kg
  S loss_constant = S(0);      ///< mu L R T / (2 D^2 A), Pa2 s/kg
  PipeFriction<S> friction;

  SteadyLine() noexcept = default;
  /// length_m, diameter_m > 0.
  SteadyLine(const Air<S>& air, const LineParameters<S>& line) noexcept : friction(line, air) {
    const S section_m2 = line.section_m2();
    reynolds_per_flow = line.diameter_m / (section_m2 * air.viscosity_Pas);
    loss_constant = air.viscosity_Pas * line.length_m * air.R * air.temperature_K /
                    (S(2) * line.diameter_m * line.diameter_m * section_m2);
  }
};

/// Darcy-Weisbach loss [Pa] of a steady flow G [kg/s], with its sign, at the mean absolute pressure [Pa] > 0:
/// lambda/(2D) rho u |u| L = lambda Re mu L R T G / (2 D^2 A p), lambda as in the line itself. HOT.
template <class S>
S steady_line_loss_Pa(const SteadyLine<S>& line, const S& mass_flow_kgps, const S& mean_pressure_Pa) noexcept {
  const S reynolds = line.reynolds_per_flow * absolute(mass_flow_kgps);
  return (line.loss_constant / mean_pressure_Pa) * (line.friction(reynolds).lambda_reynolds * mass_flow_kgps);
}

/// Inverse of one five-port spool and two chambers with their lines, quasi-steady.
class FlowFeedforward {
 public:
  FlowFeedforward() noexcept = default;
  /// Cold. Takes gas, supply, valve, lines, cylinder and slider (mass with payload).
  explicit FlowFeedforward(const AxisParameters<double>& axis) noexcept;

  /// Signed spool area [m2] (> 0: port 1 fills) for the motion `ahead` (reference at t + lead) at the chamber pressures
  /// in use [Pa, absolute]; supply_Pa: measured, NaN for that of the axis. Not limited to area_max. HOT: three passes
  /// for the port pressures.
  double area_m2(const ReferencePoint& ahead, double p1_Pa, double p2_Pa, double supply_Pa) const noexcept;
  double area_m2(const ReferencePoint& ahead, double p1_Pa, double p2_Pa) const noexcept {
    return area_m2(ahead, p1_Pa, p2_Pa, supply_Pa_);
  }
  /// The command for that area [V]. HOT.
  double command_V(const ReferencePoint& ahead, double p1_Pa, double p2_Pa, double supply_Pa) const noexcept {
    return area_m2(ahead, p1_Pa, p2_Pa, supply_Pa) * volt_per_area_;
  }
  /// What the flow of a motion loses along each line, port less chamber [Pa]. HOT: two passes.
  std::array<double, 2> line_loss_Pa(const ReferencePoint& now, double p1_Pa, double p2_Pa) const noexcept;
  /// Force [N] for the motion at t: m a + B v. HOT.
  double motion_force_N(const ReferencePoint& now) const noexcept {
    return mass_kg_ * now.d[2] + viscous_Ns_per_m_ * now.d[1];
  }

 private:
  /// Side 1 and side 2: both go through each pass at once, for a pass is one chain of roots and divisions.
  using Lanes = Pack<double, 2>;
  /// Both sides of the axis in one motion.
  struct Flow {
    double wanted = 0.0;  ///< force rate, and what the motion takes away by compression [N/s]
    double supply_Pa = 0.0;
    Lanes chamber_Pa, area_per_volume_per_m;
    Lanes mean_of_swept_kgps, mean_of_valve;  ///< mean flow of a line: the first, and the second times the valve's
  };
  Flow flow(const ReferencePoint& motion, double p1_Pa, double p2_Pa, double supply_Pa) const noexcept;
  /// Area for the flow, and each port's flux per area [kg/s m2], at this loss along each line.
  struct Spool {
    double area_m2 = 0.0;
    Lanes flux;
  };
  Spool spool(const Flow& flow, const Lanes& loss_Pa) const noexcept;
  Lanes loss_Pa(const Flow& flow) const noexcept;
  Lanes flux(const Lanes& port_Pa, double supply_Pa, bool side_1_fills) const noexcept;

  Lanes area_m2_, moved_area_m2_;  ///< moved: what a step of the piston adds to each side
  Lanes middle_volume_m3_, dead_volume_m3_, line_volume_m3_;
  SteadyLine<Lanes> lines_;
  double mass_kg_ = 0.0, viscous_Ns_per_m_ = 0.0, volt_per_area_ = 0.0;
  double gas_R_T_ = 1.0, flux_per_pressure_ = 0.0, supply_Pa_ = 1.0, atmosphere_Pa_ = 1.0,
         critical_pressure_ratio_ = 0.5;
};

/// How far ahead the feedforward should look [s]: the lag of line resistance and chamber,
/// tau = R_l C_l (C_c/2 + C_l/3)/(C_l + C_c), the mean of both sides. Peak speed of the reference [m/s], mean chamber
/// pressure [Pa]. Cold.
double feedforward_lead_s(const AxisParameters<double>& axis, double peak_speed_mps, double mean_pressure_Pa) noexcept;

}  // namespace pneuservo
