// Timing of a loop: histograms of lateness and work per stage, and the worst cycles; fixed memory, no locks.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include <pneuservo/core/rt.hpp>

namespace pneuservo {

/// Counts of times in bins of integer nanoseconds: exact below 128 ns, above it 64 equal bins to the octave (at most
/// 1.6 % wide), up to 1.07 s; longer times count in the last bin. Nothing is allocated, adding takes a few shifts.
class TimeHistogram {
 public:
  static constexpr int bins_per_octave_log2 = 6;
  static constexpr int bins_per_octave = 1 << bins_per_octave_log2;
  static constexpr int octaves = 30;
  static constexpr std::int64_t limit_ns = std::int64_t{1} << octaves;
  static constexpr int bins = bins_per_octave * (octaves - bins_per_octave_log2 + 1);

  /// Adds one time [ns]; negative counts as 0.
  void add(std::int64_t time_ns) noexcept PNEUSERVO_NONBLOCKING {
    time_ns = std::max<std::int64_t>(time_ns, 0);
    ++counts_[static_cast<std::size_t>(bin_of(time_ns))];
    ++total_;
    sum_ns_ += time_ns;
    maximum_ns_ = std::max(maximum_ns_, time_ns);
  }
  /// Adds all counts of another histogram.
  void add(const TimeHistogram& other) noexcept {
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
    total_ += other.total_;
    sum_ns_ += other.sum_ns_;
    maximum_ns_ = std::max(maximum_ns_, other.maximum_ns_);
  }
  std::int64_t count() const noexcept { return total_; }
  double maximum_us() const noexcept { return static_cast<double>(maximum_ns_) * 1e-3; }
  double mean_us() const noexcept {
    return total_ > 0 ? static_cast<double>(sum_ns_) / static_cast<double>(total_) * 1e-3 : 0.0;
  }

  /// Time [us] that the fraction `quantile` (0..1) of the counts does not exceed; to the bin's width, 1.6 %.
  double percentile_us(double quantile) const noexcept {
    const auto wanted = static_cast<std::int64_t>(std::ceil(quantile * static_cast<double>(total_)));
    std::int64_t seen = 0;
    for (int i = 0; i < bins - 1; ++i) {
      seen += counts_[static_cast<std::size_t>(i)];
      if (seen >= wanted && seen > 0) return std::min(upper_us(i), maximum_us());
    }
    return maximum_us();
  }
  std::int64_t bin_count(int bin) const noexcept { return counts_[static_cast<std::size_t>(bin)]; }
  /// Longest time that counts in this bin [us] (the last bin also counts all longer ones).
  static double upper_us(int bin) noexcept { return static_cast<double>(upper_ns(bin)) * 1e-3; }
  static constexpr std::int64_t upper_ns(int bin) noexcept {
    if (bin < 2 * bins_per_octave) return bin;
    const int shift = bin / bins_per_octave - 1;
    return (static_cast<std::int64_t>(bins_per_octave + bin % bins_per_octave + 1) << shift) - 1;
  }
  /// Bin of a time >= 0 [ns]: the octave's number above the leading bit's next six bits.
  static constexpr int bin_of(std::int64_t time_ns) noexcept {
    if (time_ns >= limit_ns) return bins - 1;
    const auto time = static_cast<std::uint32_t>(time_ns);
    const int shift = std::max(static_cast<int>(std::bit_width(time)) - bins_per_octave_log2 - 1, 0);
    return (shift << bins_per_octave_log2) + static_cast<int>(time >> shift);
  }

 private:
  std::array<std::int64_t, bins> counts_{};
  std::int64_t total_ = 0;
  std::int64_t maximum_ns_ = 0;
  std::int64_t sum_ns_ = 0;
};

/// One late or long cycle.
struct WorstCycle {
  std::int64_t tick = -1;
  std::int64_t lateness_ns = 0;
  std::int64_t work_ns = 0;
  std::int64_t total_ns() const noexcept { return lateness_ns + work_ns; }
};

/// All timing of one run. `work` is all of a tick, `tick` all but the backend's part, `loop` what of that is neither
/// estimator nor controller.
struct LoopTiming {
  TimeHistogram lateness, work, tick, loop, estimator, controller, backend;
  std::array<WorstCycle, 16> worst{};
  std::int64_t worst_kept_ns = -1;  ///< lateness + work of the mildest kept cycle; -1 while there is room
  std::int64_t ticks = 0;
  std::int64_t overruns = 0;
  std::int64_t page_faults = 0;
  std::int64_t context_switches_involuntary = 0;

  /// Keeps the cycle if it is among the 16 worst by lateness + work.
  void keep_worst(const WorstCycle& cycle) noexcept PNEUSERVO_NONBLOCKING {
    if (cycle.total_ns() <= worst_kept_ns) return;
    const auto milder = [](const WorstCycle& a, const WorstCycle& b) { return rank(a) < rank(b); };
    *std::min_element(worst.begin(), worst.end(), milder) = cycle;
    worst_kept_ns = rank(*std::min_element(worst.begin(), worst.end(), milder));
  }

 private:
  static std::int64_t rank(const WorstCycle& cycle) noexcept { return cycle.tick < 0 ? -1 : cycle.total_ns(); }
};

}  // namespace pneuservo
