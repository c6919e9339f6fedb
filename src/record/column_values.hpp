// What the values of a column say together.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace pneuservo {

/// Whether any of them is a number.
inline bool has_value(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// Whether two of them differ.
inline bool has_motion(const std::vector<double>& values) {
  double first = std::numeric_limits<double>::quiet_NaN();
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (std::isfinite(first) && value != first) return true;
    first = value;
  }
  return false;
}

/// The value below which this share of the finite values lies; NaN where there is none.
inline double quantile(std::vector<double> values, double share) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Two quantiles, low below high, from one copy of the values.
inline std::pair<double, double> quantiles(std::vector<double> values, double low, double high) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  const auto at = [&](double share) {
    return values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  };
  std::nth_element(values.begin(), at(low), values.end());
  const double lowest = *at(low);
  std::nth_element(at(low), at(high), values.end());
  return {lowest, *at(high)};
}

/// The upper one of two in the middle. values: at least one.
inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace pneuservo
