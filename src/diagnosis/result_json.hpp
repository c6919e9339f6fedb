// A diagnosis as JSON, format pneuservo-diagnosis/1.
#pragma once
#include <nlohmann/json.hpp>

#include "diagnosis/diagnosis.hpp"

namespace pneuservo {

nlohmann::ordered_json diagnosis_json(const Diagnosis& diagnosis);

}  // namespace pneuservo
