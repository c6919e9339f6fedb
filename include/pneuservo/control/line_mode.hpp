// The first mode of a line that is shut at the valve, and the force in which it does not show.
#pragma once
#include <array>

namespace pneuservo {

template <class S> struct AxisParameters;
template <class S> struct LineParameters;

/// How gas swings between a shut valve port and a chamber.
struct LineMode {
  double frequency_Hz = 0.0;
  double chamber_over_port = 0.0;  ///< pressure of the mode at the chamber for that at the port; below 0
};
/// Isothermal line of constant section, polytropic chamber, a piston that stands. Cold.
LineMode first_line_mode(const LineParameters<double>& line, double chamber_volume_m3, double gas_J_per_kg) noexcept;

/// Weights of the ports' pressures beside the chambers' with which the first mode of each line cancels in the force.
struct LineModeFilter {
  std::array<double, 2> port_share{};  ///< of each side, beside 1 - port_share of its chamber
  double mean_gain = 0.0;  ///< per period, of the mean that takes away what a computed loss of pressure misses
};
/// Of an axis at mid-stroke. Cold.
LineModeFilter line_mode_filter(const AxisParameters<double>& axis, double period_s) noexcept;

}  // namespace pneuservo
