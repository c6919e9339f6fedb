// The result of `design` as JSON, with units in the keys.
#pragma once
#include <nlohmann/json.hpp>

#include <design/axis_design.hpp>

namespace pneuservo {

/// Everything that the text says, to full precision; what is not known is null. Poles are [real, imaginary] in rad/s.
nlohmann::ordered_json design_json(const Rig& rig, const AxisDesign& design, bool coefficients);

}  // namespace pneuservo
