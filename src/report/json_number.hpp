// Numbers in the JSON of a report.
#pragma once
#include <cmath>

#include <nlohmann/json.hpp>

namespace pneuservo {

using Json = nlohmann::ordered_json;

/// null for what is not finite: also in memory, not only when written.
inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace pneuservo
