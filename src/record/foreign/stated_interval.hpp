// The interval or the rate of the rows as a table's head or its column names state it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "record/foreign/field_text.hpp"
#include "record/table.hpp"

namespace pneuservo {

struct StatedInterval {
  std::vector<double> intervals_s;  ///< one for all columns, or one for each that has values
  std::vector<double> starts_s;     ///< of each column; empty: not stated
  std::string line;                 ///< what says so
};

/// What "Sample rate: 1000 Hz", "Delta_X 0.001", "Zykluszeit;1 ms", "Fréquence d'échantillonnage : 1 kHz", a column
/// "Increment" with a number below or "Sample (1 kHz)" says; none where nothing does. A word of sampling counts before
/// a rate or a period alone. "Decimation: 2" makes it longer.
std::optional<StatedInterval> stated_interval(const CsvTable& table, const FieldStyle& style);

}  // namespace pneuservo
