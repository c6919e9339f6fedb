// The gas on one side of a cylinder as recorded, and what the valve's edges pass at its port.
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/residuals/force_balance.hpp"

namespace pneuservo {

/// At each instant of a recording.
struct SideGas {
  std::vector<double> port_Pa;
  std::vector<double> mass_kg;  ///< in chamber and line
  /// Through an edge of 1 m2 from the supply, and to the atmosphere [kg/(s m2)].
  std::vector<double> filling, emptying;
};

/// side: 0 or 1. A port or chamber that is not measured is taken for the other one; empty where neither is.
std::optional<SideGas> side_gas(const Rig& rig, const CylinderRecording& prepared, std::size_t side);

/// The motion, smoothed over what lies between the valve's command and the gas in the chamber: spool and sound.
ForceBalance smoothed_motion(const Rig& rig, const CylinderRecording& prepared);

}  // namespace pneuservo
