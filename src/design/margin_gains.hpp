// The highest gains of the force law that keep their margins over stroke, payload range and supply tolerance.
#pragma once
#include <optional>
#include <string>

#include <pneuservo/rig/rig.hpp>

#include "design/linear_axis.hpp"

namespace pneuservo {

/// Margins below these are warned of, and are what `highest_gains` keeps.
inline constexpr double least_gain_margin = 2.0, least_phase_margin_deg = 30.0;

/// What the search found at all operating points together.
struct MarginGains {
  double force_gain_V_per_N = 0.0, position_gain_N_per_m = 0.0, velocity_gain_Ns_per_m = 0.0;
  double error_m = 0.0;  ///< that the forces and the flow which nobody foresees leave: what is made least
  int points = 0;  ///< linear models, over the operating points, that keep the margins
};

/// The stiffest gains of pd_force whose loop keeps a gain margin of 2 (up and down) and a phase margin of 30 deg on
/// distributed lines and with their lags: over the stroke, both ends of the payload range and two standard deviations
/// of the supply. They leave the least error F/k_p + u/(k_f k_p) to the forces F (friction at the reference's speed,
/// loads) and to the command u that the tolerance of the valve's area is worth at half its range. None: no gains do.
/// Throws std::invalid_argument for another law or rig.
std::optional<MarginGains> highest_gains(const Rig& rig);

/// The rig with these gains.
Rig with_margin_gains(Rig rig, const MarginGains& gains);

/// The number of the config that holds these gains back most: with what in its place how much higher they would be.
std::string obstacle_words(const Rig& rig, const std::optional<MarginGains>& found);

}  // namespace pneuservo
