// Synthetic runs with known figures, for the tests of evaluation, tables and pages.
#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include <pneuservo/record/row.hpp>

namespace pneuservo::test {

inline double wave(double frequency_Hz, double t_s) { return std::sin(2.0 * std::numbers::pi * frequency_Hz * t_s); }

/// Rows `period_s` apart that `fill(row)` completes from row.t_s.
template <class Fill> std::vector<Row> make_rows(double duration_s, double period_s, Fill&& fill) {
  std::vector<Row> rows(static_cast<std::size_t>(std::llround(duration_s / period_s)));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].t_s = static_cast<double>(k) * period_s;
    fill(rows[k]);
  }
  return rows;
}

}  // namespace pneuservo::test
