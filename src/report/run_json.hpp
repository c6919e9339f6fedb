// The result of `run` as JSON, with units in the keys.
#pragma once
#include <nlohmann/json.hpp>

#include <report/run_result.hpp>

namespace pneuservo {

/// One object with the keys that docs/command-line.md lists, in that order; a figure that is not known is null; the
/// latency keys are there in real time only.
nlohmann::ordered_json run_json(const RunReport& report);

/// Bins that are not empty, as [longest time of the bin in us, count].
nlohmann::ordered_json histogram_json(const TimeHistogram& histogram);

}  // namespace pneuservo
