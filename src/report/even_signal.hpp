// A column of a run on an even grid in time.
#pragma once
#include <vector>

#include <pneuservo/record/row.hpp>

namespace pneuservo {

/// Values period_s apart from from_s on; empty where the rows do not hold two values.
struct EvenSignal {
  double from_s = 0.0, period_s = 0.0;
  std::vector<double> values;
};

/// The sampling period of at least two rows: the median distance, which lost rows do not move.
double sampling_period_s(const std::vector<Row>& rows);

/// Lost rows and missing values are bridged by straight lines.
EvenSignal even_signal(const std::vector<Row>& rows, RowColumn column);

}  // namespace pneuservo
