// Flow feedforward: the valve area that gives the force rate a reference asks for (docs/physics/pd_force.md).
#pragma once
#include <array>
#include <cmath>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/pipe_friction.hpp>

namespace pneuservo {

template <class S> struct AxisParameters;

/// Polytropic exponent of chamber and line while the axis moves.
inline constexpr double feedforward_polytropic_exponent = 1.3;

/// What the steady pressure loss of a line needs, computed once.
struct SteadyLine {
  double reynolds_per_flow = 0.0;   ///< Re = this |G|, s/kg
  double loss_constant = 0.0;       ///< mu L R T / (2 D^2 A), Pa2 s/kg
  PipeFriction<double> friction;

  SteadyLine() noexcept = default;
  /// length_m, diameter_m > 0.
  SteadyLine(const Air<double>& air, const LineParameters<double>& line) noexcept;
};

/// Darcy-Weisbach loss [Pa] of a steady flow G [kg/s], with its sign, at the mean absolute pressure [Pa] > 0:
/// lambda/(2D) rho u |u| L = lambda Re mu L R T G / (2 D^2 A p), lambda as in the line itself. HOT.
inline double steady_line_loss_Pa(const SteadyLine& line, double mass_flow_kgps, double mean_pressure_Pa) noexcept {
  const double reynolds = line.reynolds_per_flow * std::fabs(mass_flow_kgps);
  return line.loss_constant * line.friction(reynolds).lambda_reynolds * mass_flow_kgps / mean_pressure_Pa;
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
  struct Side {
    double area_m2 = 0.0, middle_volume_m3 = 0.0, dead_volume_m3 = 0.0, line_volume_m3 = 0.0;
    SteadyLine line;
  };
  /// Both sides of the axis in one motion.
  struct Flow {
    double wanted = 0.0;  ///< force rate, and what the motion takes away by compression [N/s]
    double supply_Pa = 0.0;
    std::array<double, 2> chamber_Pa{}, inverse_volume_per_m3{}, chamber_share{}, swept_W{};
  };
  Flow flow(const ReferencePoint& motion, double p1_Pa, double p2_Pa, double supply_Pa) const noexcept;
  /// Area for the flow, and each port's flux per area [kg/s m2], at this loss along each line.
  struct Spool {
    double area_m2 = 0.0;
    std::array<double, 2> flux{};
  };
  Spool spool(const Flow& flow, const std::array<double, 2>& loss_Pa) const noexcept;
  std::array<double, 2> loss_Pa(const Flow& flow) const noexcept;
  double flux(double port_Pa, double supply_Pa, bool fills) const noexcept;

  Side side_1_, side_2_;
  double mass_kg_ = 0.0, viscous_Ns_per_m_ = 0.0, volt_per_area_ = 0.0;
  double gas_R_T_ = 1.0, flux_per_pressure_ = 0.0, supply_Pa_ = 1.0, atmosphere_Pa_ = 1.0,
         critical_pressure_ratio_ = 0.5;
};

/// How far ahead the feedforward should look [s]: the lag of line resistance and chamber,
/// tau = R_l C_l (C_c/2 + C_l/3)/(C_l + C_c), the mean of both sides. Peak speed of the reference [m/s], mean chamber
/// pressure [Pa]. Cold.
double feedforward_lead_s(const AxisParameters<double>& axis, double peak_speed_mps, double mean_pressure_Pa) noexcept;

}  // namespace pneuservo
