// What is known of the safe output after a fault, in one sentence.
#pragma once
#include <string>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// "the safe output of 0 V was sent at t = 2.003 s and read back at t = 2.004 s". Nothing is said that no device
/// showed.
std::string safe_output_text(const SafeOutput& safe, const Rig& rig);

}  // namespace pneuservo
