// What pressures at the valve ports do to a slider: its force, the stiffness of the shut-in air, the speed of a
// command.
#pragma once
#include <array>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Force to positive x of both chambers at rest, where port and chamber have one pressure, and of the atmosphere on the
/// rod [N].
double air_force_N(const Rig& rig, const std::array<double, 2>& port_Pa) noexcept;
/// Volume of a side (0, 1) with the piston at x [m3]: line, dead volume, chamber; x is held within the stroke.
double side_volume_m3(const Rig& rig, std::size_t side, double position_m) noexcept;
/// Isothermal stiffness of the air of both sides [N/m], the valve closed.
double air_stiffness_N_per_m(const Rig& rig, const std::array<double, 2>& port_Pa, double position_m) noexcept;
/// Steady speed of a slider without friction per volt beyond the closing command [m/s per V], of the side that gives
/// the more: what flows in or out at this pressure over piston area and density. `direction`: +1 fills side 1.
double speed_per_volt_mps(const Rig& rig, const std::array<double, 2>& port_Pa, int direction) noexcept;

}  // namespace pneuservo
