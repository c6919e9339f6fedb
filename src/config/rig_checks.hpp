// What no single field can say: values of a config that contradict each other, and defaults that follow from others.
#pragma once
#include <string>

#include <pneuservo/rig/rig.hpp>

#include "config/config_tree.hpp"
#include "config/input_errors.hpp"

namespace pneuservo {

/// Fills what the config leaves open and other values decide: the duration, and initial pressures that the supply can
/// give where the usual 470 kPa would be too much.
void complete_rig(Rig& rig, const ConfigNode& root);

/// Tells where the law that the config names does not run that kind of rig.
void check_choice_of_law(RigKind kind, const ConfigNode& root, InputErrors& errors);

/// Tells every contradiction between sections without an error, naming the line of the key that is to blame.
void check_rig(const Rig& rig, const ConfigNode& root, InputErrors& errors);

/// Throws InputError where a valve would not be closed without this program, or would follow simulated sensors.
void check_machine_rig(const Rig& rig, const ConfigNode& root);

}  // namespace pneuservo
