// The linear model of a config's axis at its operating point, and its exact frequency response with distributed lines.
#pragma once
#include <array>
#include <complex>
#include <optional>

#include <pneuservo/control/line_mode.hpp>
#include <pneuservo/rig/rig.hpp>

#include "acoustics/line_acoustics.hpp"
#include "design/linear_axis.hpp"

namespace pneuservo {

/// Of the command on its way to the valve's spool.
inline double delay_s(const Rig& rig) {
  return rig.axis.effects.valve.command_delay.delay_s + rig.controller.command_delay_s();
}

/// Where the lag that stands for a line comes from.
enum class LagSource { config, resonance, low_frequency };

/// Valve edges, line and chamber of one side at the operating point.
struct AxisSide {
  double pressure_Pa = 0.0, piston_area_m2 = 0.0, chamber_volume_m3 = 0.0;
  double flow_kgps_per_V = 0.0;              ///< mean of charging and discharging
  SecondOrderLag lag;                        ///< of the line in the linear model
  LagSource source = LagSource::resonance;
  std::optional<LineResonance> resonance;    ///< by the exact theory with this chamber; none: damped away
};

/// docs/design.md says what is modelled and what is not.
struct AxisLinearisation {
  LinearAxis axis;
  std::array<AxisSide, 2> sides;
  std::array<LineAcoustics, 2> lines;
  std::optional<LineModeFilter> modal_filter;  ///< of a law that has one
  double polytropic_exponent = 1.0;          ///< of the chambers
  double mass_kg = 0.0, friction_Ns_per_m = 0.0;
  double discharge_ratio = 0.0;              ///< delta (2.8), of a servo table
  double speed_per_area_per_ms = 0.0;        ///< K_n [1/(m s)], of a servo table
};

/// A servo table at mid-stroke and controller.equilibrium_pressure_Pa (isothermal, chapter 2); a cylinder at its
/// `initial` position and pressures (polytropic as its flow feedforward, line volumes in the air springs). Lags: a
/// line's natural_frequency_Hz and damping_ratio where the config has them, else its resonance by the exact theory.
AxisLinearisation linearise(const Rig& rig);

/// Small changes over the command [per V] at s, with distributed lines and frequency-dependent friction.
struct AxisResponse {
  std::complex<double> position_m, chamber_force_N, port_force_N;
  std::array<std::complex<double>, 2> port_less_chamber_N;  ///< by side; their sum is that of the forces
};
AxisResponse exact_response(const AxisLinearisation& linear, std::complex<double> s);

/// The force in a loop that feeds back the ports' pressures [N per V], sampled with z: distributed lines alone tell it.
std::complex<double> seen_force_N(const AxisLinearisation& linear, const AxisResponse& axis, std::complex<double> z);

}  // namespace pneuservo
