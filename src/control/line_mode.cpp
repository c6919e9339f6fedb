// The first mode of a line that is shut at the valve, and the force in which it does not show.
#include <pneuservo/control/line_mode.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <pneuservo/control/flow_feedforward.hpp>
#include <pneuservo/rig/axis.hpp>

namespace pneuservo {
namespace {

/// Corner of the mean for the slower mode: the lead at the mode is atan(0.05), 3 degrees.
constexpr double mean_share = 0.05;

}  // namespace

// p = cos(k x) from the shut port; what flows into the chamber fills it: tan(k L) = -k L V/(n A L).
LineMode first_line_mode(const LineParameters<double>& line, double chamber_volume_m3, double gas_J_per_kg) noexcept {
  const double ratio = chamber_volume_m3 / (feedforward_polytropic_exponent * line.volume_m3());
  double low = 0.5 * std::numbers::pi, high = std::numbers::pi;
  for (int i = 0; i < 52; ++i) {  // to the last bit
    const double middle = 0.5 * (low + high);
    (std::sin(middle) + ratio * middle * std::cos(middle) > 0.0 ? low : high) = middle;
  }
  return {low * std::sqrt(gas_J_per_kg) / (2.0 * std::numbers::pi * line.length_m), std::cos(low)};
}

LineModeFilter line_mode_filter(const AxisParameters<double>& axis, double period_s) noexcept {
  const auto& c = axis.cylinder;
  const double half_m = 0.5 * c.stroke_m, gas = axis.air.gas_constant_J_per_kgK * axis.air.temperature_K;
  const std::array modes{first_line_mode(axis.line_1, c.dead_volume_1_m3 + c.area_1_m2 * half_m, gas),
                         first_line_mode(axis.line_2, c.dead_volume_2_m3 + c.area_2_m2 * half_m, gas)};
  LineModeFilter out;
  for (std::size_t i = 0; i < 2; ++i)
    out.port_share[i] = modes[i].chamber_over_port / (modes[i].chamber_over_port - 1.0);
  const double slower_Hz = std::min(modes[0].frequency_Hz, modes[1].frequency_Hz);
  out.mean_gain = -std::expm1(-2.0 * std::numbers::pi * mean_share * slower_Hz * period_s);
  return out;
}

}  // namespace pneuservo
