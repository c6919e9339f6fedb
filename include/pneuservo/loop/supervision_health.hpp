// Health of supervision itself: shares of bad samples and missed slots, rest of the cross-checks, suspend of the
// machine.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <pneuservo/loop/cross_check.hpp>
#include <pneuservo/loop/fault.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// What the guards in front of it let pass for ever: each sample or slot is bridged, the sum is not. One object an
/// axis, part of the Supervisor; everything but configure is HOT.
///
/// A share is the exponential mean of 0 and 1 over window_s (at least shortest_window_ticks): a true share p is found
/// after -window ln(1 - limit/p), 0.19 s for 21 % of slots and 0.05 s for two of three samples at a limit of 10 %.
/// Independent losses of a share q scatter it by sqrt(q period / (2 window)): 0.4 % at q = 1 %, 23 times below 10 %.
class SupervisionHealth {
 public:
  static constexpr double window_s = 0.3;
  /// So that the two samples in a row that a guard bridges are 2 % at the most.
  static constexpr double shortest_window_ticks = 100.0;
  /// Of limits.missed_share: one gap counts no more, for its length is the matter of limits.lateness_s. Two of them
  /// within 0.25 s are a fault, as are gaps of 21 % that are 50 ms long.
  static constexpr double most_of_one_gap = 0.7;
  /// Smaller shares are none; without end they would become subnormal numbers, which are slow.
  static constexpr double least_share = 1e-12;
  /// Of the stroke: less motion changes less air than CrossCheck::floor_share, which no check sees either.
  static constexpr double moving_share = CrossCheck::floor_share;

  void configure(const Rig& rig) {
    bad_limit_ = rig.limits.bad_share;
    missed_limit_ = rig.limits.missed_share;
    rest_limit_ticks_ = rig.limits.checks_rest_s / rig.period_s;
    checks_exist_ = rig.limits.checks_rest_s > 0.0 &&
                    (rig.limits.flow_mismatch_share > 0.0 || rig.limits.chamber_mismatch_Pa > 0.0);
    moving_m_ = moving_share * rig.axis.cylinder.stroke_m;
    window_ticks_ = std::max(window_s / rig.period_s, shortest_window_ticks);
    keep_ = std::exp(-1.0 / window_ticks_);
    reset();
  }
  void reset() noexcept {
    bad_ = {};
    bad_lately_ = false;
    missed_ = rested_ticks_ = 0.0;
    slept_before_ns_ = slept_ns_;
  }

  /// Whether the sample of each signal of this tick was bad (missing, too old, a jump); and the slots that were
  /// skipped before it.
  std::uint64_t check_tick(const PerSignal<bool>& bad, std::int64_t skipped) noexcept {
    std::uint64_t faults = 0;
    if (bad_lately_ || std::ranges::find(bad.all, true) != bad.all.end()) [[unlikely]]
      faults |= check_bad(bad);
    if (skipped > 0) note_gap(skipped);
    missed_ = missed_ > least_share ? keep_ * missed_ : 0.0;
    if (missed_ > missed_limit_) faults |= fault_missed_slots;
    if (slept_ns_ > slept_before_ns_) faults |= fault_suspended;
    return faults;
  }
  /// `watching`: the cross-checks judged this tick. Only where the axis is active.
  std::uint64_t check_rest(bool watching, double position_m, std::int64_t skipped) noexcept {
    if (watching || !checks_exist_) {
      rested_ticks_ = 0.0;
      return 0;
    }
    if (rested_ticks_ == 0.0) lowest_m_ = highest_m_ = position_m;
    rested_ticks_ += static_cast<double>(skipped + 1);
    lowest_m_ = std::min(lowest_m_, position_m);
    highest_m_ = std::max(highest_m_, position_m);
    const bool moves = highest_m_ - lowest_m_ > moving_m_;
    return moves && rested_ticks_ > rest_limit_ticks_ ? std::uint64_t{fault_checks_rested} : 0;
  }
  /// Time that the machine has been suspended so far [ns]; the loop alone reads clocks.
  void note_slept(std::int64_t slept_ns) noexcept { slept_ns_ = slept_ns; }

  double bad_share(Signal signal) const noexcept { return bad_[signal]; }
  double missed_share() const noexcept { return missed_; }

 private:
  std::uint64_t check_bad(const PerSignal<bool>& bad) noexcept {
    std::uint64_t faults = 0;
    bad_lately_ = false;
    for (const Signal signal : channel_signals) {
      const double kept = bad_[signal] > least_share ? keep_ * bad_[signal] : 0.0;
      bad_[signal] = kept + (bad[signal] ? 1.0 - keep_ : 0.0);
      bad_lately_ = bad_lately_ || bad_[signal] > 0.0;
      if (bad_[signal] > bad_limit_)
        faults |= is_in_pascal(signal) ? fault_pressure_unreliable : fault_position_unreliable;
    }
    return faults;
  }
  void note_gap(std::int64_t slots) noexcept {
    const double kept = std::exp(-static_cast<double>(slots) / window_ticks_);
    missed_ = kept * missed_ + std::min(1.0 - kept, most_of_one_gap * missed_limit_);
  }

  double bad_limit_ = 1.0, missed_limit_ = 1.0, rest_limit_ticks_ = 0.0, moving_m_ = 0.0, window_ticks_ = 300.0,
         keep_ = 1.0;
  bool checks_exist_ = false, bad_lately_ = false;
  PerSignal<double> bad_;
  double missed_ = 0.0, rested_ticks_ = 0.0, lowest_m_ = 0.0, highest_m_ = 0.0;
  std::int64_t slept_ns_ = 0, slept_before_ns_ = 0;
};

}  // namespace pneuservo
