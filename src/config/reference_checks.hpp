// What no single key of a reference can be checked for.
#pragma once
#include <string>

#include <pneuservo/rig/rig.hpp>

#include "config/check.hpp"
#include "config/config_tree.hpp"

namespace pneuservo {

/// Key of the stroke.
std::string stroke_key(const Rig& rig);

/// Length of a run that shows all of a reference: a second after the last move, oscillations ten periods long.
double default_duration_s(const ReferenceSpec& spec, const ConfigNode& root);

/// Its positions against the stroke, its frequencies against the period.
void check_reference_range(const Rig& rig, const Check& check);

/// A reference that no machine of this config can follow must not be started.
void check_reference_motion(const Rig& rig, const Check& check);

/// What a reference alone can break: lists of different length, times that do not increase.
void check_reference_keys(const ReferenceSpec& reference, const ConfigNode& node, const std::string& path);

}  // namespace pneuservo
