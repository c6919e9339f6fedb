// Where a function of one variable with one valley is least.
#pragma once
#include <cmath>
#include <utility>

namespace pneuservo {

/// Middle of the last interval, which is no wider than `width`; each step costs one value. Cold.
template <class Function> double golden_section_minimum(const Function& value, double low, double high, double width) {
  const double share = 0.5 * (std::sqrt(5.0) - 1.0);
  double a = high - share * (high - low), b = low + share * (high - low), at_a = value(a), at_b = value(b);
  while (high - low > width)
    if (at_a < at_b) {
      high = std::exchange(b, a);
      at_b = std::exchange(at_a, value(a = high - share * (high - low)));
    } else {
      low = std::exchange(a, b);
      at_a = std::exchange(at_b, value(b = low + share * (high - low)));
    }
  return 0.5 * (low + high);
}

}  // namespace pneuservo
