// A column of a run on an even grid in time.
#include <report/even_signal.hpp>

#include <algorithm>
#include <cmath>

#include "record/column_values.hpp"

namespace pneuservo {

double sampling_period_s(const std::vector<Row>& rows) {
  std::vector<double> distances;
  distances.reserve(rows.size());
  for (std::size_t k = 1; k < rows.size(); ++k) distances.push_back(rows[k].t_s - rows[k - 1].t_s);
  return median_of(std::move(distances));
}

EvenSignal even_signal(const std::vector<Row>& rows, RowColumn column) {
  std::vector<const Row*> whole;
  for (const Row& row : rows)
    if (std::isfinite(column.of(row))) whole.push_back(&row);
  if (whole.size() < 2) return {};
  EvenSignal signal{whole.front()->t_s, sampling_period_s(rows), {}};
  if (!(signal.period_s > 0.0)) return {};
  const double length_s = whole.back()->t_s - signal.from_s;
  const auto count = static_cast<std::size_t>(std::llround(length_s / signal.period_s)) + 1;
  signal.values.reserve(count);
  std::size_t right = 1;
  for (std::size_t k = 0; k < count; ++k) {
    const double t_s = signal.from_s + static_cast<double>(k) * signal.period_s;
    while (right + 1 < whole.size() && whole[right]->t_s < t_s) ++right;
    const Row &a = *whole[right - 1], &b = *whole[right];
    const double share = std::clamp((t_s - a.t_s) / (b.t_s - a.t_s), 0.0, 1.0);
    signal.values.push_back(column.of(a) + share * (column.of(b) - column.of(a)));
  }
  return signal;
}

}  // namespace pneuservo
