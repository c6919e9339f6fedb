// The sections `effects` and `concealed`: physics by name, on the axis and on its sensors (sensor_offset:x).
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "config/config_tree.hpp"
#include "config/input_errors.hpp"

namespace pneuservo {

/// Every name the section knows: effects of the axis, then sensor_*:CHANNEL.
std::vector<std::string> effect_names(const Rig& rig);

/// Reads the section into `rig.axis.effects` and `rig.sensor_effects`; errors of single effects go to `errors`.
void read_effects(ConfigNode& node, const std::string& path, Rig& rig, InputErrors& errors);
/// The same keys for what the simulated machine has instead, into `rig.concealed`.
void read_concealed(ConfigNode& node, const std::string& path, Rig& rig, InputErrors& errors);

}  // namespace pneuservo
