// Minimum of a function of several variables without derivatives (Nelder and Mead, 1965).
#pragma once
#include <functional>
#include <vector>

namespace pneuservo {

/// What the search found.
struct Minimum {
  std::vector<double> at;
  double value = 0.0;
};

/// Searches from `start` with a simplex whose edges are `relative_step` of each variable, restarts from what it found
/// until that brings nothing. `value` may return infinity where there is no answer, but not at `start`.
Minimum nelder_mead(const std::function<double(const std::vector<double>&)>& value, const std::vector<double>& start,
                    double relative_step = 0.05, double tolerance = 1e-12);

}  // namespace pneuservo
