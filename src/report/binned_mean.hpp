// Means with spread of one quantity over bins of another: where along the stroke, the speed, the command it lives.
#pragma once
#include <cstddef>
#include <vector>

namespace pneuservo {

/// Bins of equal width that hold at least `least` values, in rising order.
struct BinnedMean {
  std::vector<double> center, mean, deviation;  ///< deviation: standard deviation of the values in the bin
  std::vector<std::size_t> count;
};

/// Values that are not finite are left out. Bins span the 0.5 to 99.5 % of x, so that a few far values do not widen
/// them. bins >= 1; x and y of one length. Empty where nothing is left.
BinnedMean binned_mean(const std::vector<double>& x, const std::vector<double>& y, std::size_t bins,
                       std::size_t least = 5);

}  // namespace pneuservo
