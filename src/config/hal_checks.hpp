// What no single field of the section `hal` can say: names that must meet, objects that must fit into a PDO.
#pragma once
#include <functional>
#include <string>

#include <pneuservo/rig/rig.hpp>

#include "config/input_errors.hpp"

namespace pneuservo {

/// Refuses `path` with what was found and expected.
using RefusePath = std::function<void(const std::string& path, const std::string& found, const std::string& expected)>;

/// Calls `refuse` (which throws) at the contradictions of rig.hal, the first of each channel and device; what it throws
/// goes to `errors`. Does nothing where the rig has none.
void check_hal(const Rig& rig, InputErrors& errors, const RefusePath& refuse);

/// The same where an output has nothing that closes it without this program, or a real valve would follow simulated
/// sensors of its law and nothing calls that a bench.
void check_outputs_without_us(const Rig& rig, const RefusePath& refuse);

}  // namespace pneuservo
