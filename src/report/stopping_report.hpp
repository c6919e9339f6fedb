// Stopping times and distances of a rig in words and as JSON.
#pragma once
#include <string>

#include <nlohmann/json.hpp>

#include <pneuservo/rig/rig.hpp>

#include "loop/stopping.hpp"

namespace pneuservo {

std::string stopping_text(const Rig& rig, const StoppingTable& table);
nlohmann::ordered_json stopping_json(const Rig& rig, const StoppingTable& table);

}  // namespace pneuservo
