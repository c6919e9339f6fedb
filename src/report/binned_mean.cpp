// Means with spread of one quantity over bins of another.
#include <report/binned_mean.hpp>

#include <algorithm>
#include <cmath>

namespace pneuservo {

BinnedMean binned_mean(const std::vector<double>& x, const std::vector<double>& y, std::size_t bins,
                       std::size_t least) {
  BinnedMean out;
  std::vector<double> sorted;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::isfinite(x[i]) && std::isfinite(y[i])) sorted.push_back(x[i]);
  if (sorted.empty()) return out;
  std::sort(sorted.begin(), sorted.end());
  const double from = sorted[sorted.size() / 200], to = sorted[sorted.size() - 1 - sorted.size() / 200];
  const double width = (to - from) / static_cast<double>(bins);
  std::vector<double> sum(bins, 0.0), squares(bins, 0.0);
  std::vector<std::size_t> count(bins, 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i]) || x[i] < from || x[i] > to) continue;
    const std::size_t bin = width > 0 ? std::min(bins - 1, static_cast<std::size_t>((x[i] - from) / width)) : 0;
    sum[bin] += y[i];
    ++count[bin];
  }
  for (std::size_t i = 0; i < x.size(); ++i) {  // about the mean: no cancellation
    if (!std::isfinite(x[i]) || !std::isfinite(y[i]) || x[i] < from || x[i] > to) continue;
    const std::size_t bin = width > 0 ? std::min(bins - 1, static_cast<std::size_t>((x[i] - from) / width)) : 0;
    const double away = y[i] - sum[bin] / static_cast<double>(count[bin]);
    squares[bin] += away * away;
  }
  for (std::size_t bin = 0; bin < bins; ++bin) {
    if (count[bin] < std::max<std::size_t>(least, 1)) continue;
    const double n = static_cast<double>(count[bin]);
    out.center.push_back(from + width * (static_cast<double>(bin) + 0.5));
    out.mean.push_back(sum[bin] / n);
    out.deviation.push_back(std::sqrt(squares[bin] / n));
    out.count.push_back(count[bin]);
  }
  return out;
}

}  // namespace pneuservo
