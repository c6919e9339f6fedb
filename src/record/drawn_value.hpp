// A value between the samples of a column.
#pragma once
#include <cstddef>
#include <vector>

namespace pneuservo {

/// At `at` between samples i and i + 1: of the cubic through four samples, where none of their steps is longer than
/// `longest`, else of the line through the inner two.
inline double drawn_value(const std::vector<double>& t, const std::vector<double>& y, std::size_t i, double at,
                          double longest) {
  const bool has_outer = i >= 1 && i + 2 < t.size() && t[i] - t[i - 1] <= longest && t[i + 2] - t[i + 1] <= longest;
  if (!has_outer) return y[i] + (y[i + 1] - y[i]) * (at - t[i]) / (t[i + 1] - t[i]);
  double sum = 0;
  for (std::size_t a = i - 1; a <= i + 2; ++a) {
    double weight = y[a];
    for (std::size_t b = i - 1; b <= i + 2; ++b)
      if (b != a) weight *= (at - t[b]) / (t[a] - t[b]);
    sum += weight;
  }
  return sum;
}

}  // namespace pneuservo
