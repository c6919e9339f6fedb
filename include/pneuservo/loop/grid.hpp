// The absolute time grid of a loop: slot k is at start + k period for ever; a late tick skips slots, never shifts them.
#pragma once
#include <cstdint>

#include <pneuservo/core/rt.hpp>

namespace pneuservo {

/// Pure arithmetic on integer nanoseconds, so that rounding never accumulates and a test needs no clock.
class TimeGrid {
 public:
  /// `period_ns` > 0; slot 0 is at `start_ns`.
  constexpr TimeGrid(std::int64_t start_ns, std::int64_t period_ns) noexcept
      : period_ns_(period_ns), slot_ns_(start_ns) {}

  /// Number k of the current slot.
  constexpr std::int64_t slot() const noexcept { return slot_; }
  /// Time of the current slot, start + k period [ns].
  constexpr std::int64_t slot_ns() const noexcept { return slot_ns_; }
  constexpr std::int64_t period_ns() const noexcept { return period_ns_; }
  /// Slots skipped so far.
  constexpr std::int64_t missed() const noexcept { return missed_; }
  /// How far `now_ns` is behind the current slot [ns]; negative: ahead of it.
  constexpr std::int64_t lateness_ns(std::int64_t now_ns) const noexcept { return now_ns - slot_ns_; }

  /// Ends the current slot at `now_ns` (after the tick's work) and moves to the first later slot that is not yet past.
  /// Returns how many slots were skipped; they are never caught up, so that ticks never run back to back.
  constexpr std::int64_t advance(std::int64_t now_ns) noexcept PNEUSERVO_NONBLOCKING {
    ++slot_;
    slot_ns_ += period_ns_;
    if (slot_ns_ >= now_ns) return 0;
    const std::int64_t skipped = (now_ns - slot_ns_ + period_ns_ - 1) / period_ns_;
    slot_ += skipped;
    slot_ns_ += skipped * period_ns_;
    missed_ += skipped;
    return skipped;
  }
  /// A clock of the devices' own has come to the current slot, `samples` of its periods after the last one. Returns how
  /// many slots were skipped.
  constexpr std::int64_t follow(std::int64_t at_ns, std::int64_t samples) noexcept PNEUSERVO_NONBLOCKING {
    const std::int64_t skipped = samples > 1 ? samples - 1 : 0;
    slot_ += skipped;
    slot_ns_ = at_ns;
    missed_ += skipped;
    return skipped;
  }
  /// The next slot is a period from now: what held the loop up was meant to.
  constexpr void restart(std::int64_t now_ns) noexcept {
    ++slot_;
    slot_ns_ = now_ns + period_ns_;
  }

 private:
  std::int64_t period_ns_, slot_ns_;
  std::int64_t slot_ = 0, missed_ = 0;
};

}  // namespace pneuservo
