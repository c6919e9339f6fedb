// Timing of a loop: histograms of lateness and work per stage, and the worst cycles; fixed memory, no locks.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace pneuservo {

/// Counts of times in logarithmic bins: 64 to the octave (1.1 % wide), from 1 ns to about 1 s; nothing is allocated.
class TimeHistogram {
 public:
  static constexpr int bins_per_octave = 64;
  static constexpr int octaves = 30;
  static constexpr int bins = bins_per_octave * octaves;

  /// Adds one time [ns]; negative counts as 0, more than a second as the last bin.
  void add(std::int64_t time_ns) noexcept {
    ++counts_[static_cast<std::size_t>(bin_of(time_ns))];
    ++total_;
    sum_ns_ += static_cast<double>(time_ns);
    maximum_ns_ = std::max(maximum_ns_, time_ns);
  }
  std::int64_t count() const noexcept { return total_; }
  double maximum_us() const noexcept { return static_cast<double>(maximum_ns_) * 1e-3; }
  double mean_us() const noexcept { return total_ > 0 ? sum_ns_ / static_cast<double>(total_) * 1e-3 : 0.0; }

  /// Time [us] that the fraction `quantile` (0..1) of the counts does not exceed; to the bin's width, 1.1 %.
  double percentile_us(double quantile) const noexcept {
    const auto wanted = static_cast<std::int64_t>(std::ceil(quantile * static_cast<double>(total_)));
    std::int64_t seen = 0;
    for (int i = 0; i < bins; ++i) {
      seen += counts_[static_cast<std::size_t>(i)];
      if (seen >= wanted && seen > 0) return std::min(upper_us(i), maximum_us());
    }
    return maximum_us();
  }
  std::int64_t bin_count(int bin) const noexcept { return counts_[static_cast<std::size_t>(bin)]; }
  /// Upper edge of a bin [us].
  static double upper_us(int bin) noexcept { return std::exp2(static_cast<double>(bin + 1) / bins_per_octave) * 1e-3; }

 private:
  static int bin_of(std::int64_t time_ns) noexcept {
    if (time_ns < 1) return 0;
    const int bin = static_cast<int>(std::log2(static_cast<double>(time_ns)) * bins_per_octave);
    return std::min(bin, bins - 1);
  }
  std::array<std::int64_t, bins> counts_{};
  std::int64_t total_ = 0;
  std::int64_t maximum_ns_ = 0;
  double sum_ns_ = 0.0;
};

/// One late or long cycle.
struct WorstCycle {
  std::int64_t tick = -1;
  std::int64_t lateness_ns = 0;
  std::int64_t work_ns = 0;
};

/// All timing of one run. `loop` is the loop's own work without estimator, controller and backend.
struct LoopTiming {
  TimeHistogram lateness, loop, estimator, controller, backend;
  std::array<WorstCycle, 16> worst{};
  std::int64_t ticks = 0;
  std::int64_t overruns = 0;
  std::int64_t page_faults = 0;
  std::int64_t context_switches_involuntary = 0;

  /// Keeps the cycle if it is among the 16 worst by lateness + work.
  void keep_worst(const WorstCycle& cycle) noexcept {
    auto least = std::min_element(worst.begin(), worst.end(), [](const WorstCycle& a, const WorstCycle& b) {
      return a.lateness_ns + a.work_ns < b.lateness_ns + b.work_ns;
    });
    if (least->tick < 0 || cycle.lateness_ns + cycle.work_ns > least->lateness_ns + least->work_ns) *least = cycle;
  }
};

}  // namespace pneuservo
