// Rows from the loop to the recording writer: a wait-free memory of the last cycles that is never full.
#pragma once
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include <pneuservo/record/row.hpp>

namespace pneuservo {

/// The last rows, newest over oldest. One writer, one reader; neither waits. A row that is overwritten while it is
/// read is reported as gone, never returned torn: its number is taken out first and put back last, and every word is
/// atomic (plain moves on x86-64).
class LastRows {
 public:
  explicit LastRows(std::size_t rows) : slots_(rows > 0 ? rows : 1) {}
  std::size_t size() const noexcept { return slots_.size(); }

  /// HOT. Asks for the memory of that row, so that keep() finds it in the cache.
  void prefetch(std::int64_t number) const noexcept {
    const auto* const slot = reinterpret_cast<const char*>(&slots_[static_cast<std::size_t>(number) % slots_.size()]);
    for (std::size_t offset = 0; offset < sizeof(Slot); offset += 64) __builtin_prefetch(slot + offset, 1);
  }
  /// HOT. Keeps the row under its number (0, 1, 2, ...).
  void keep(std::int64_t number, const Row& row) noexcept {
    Slot& slot = slots_[static_cast<std::size_t>(number) % slots_.size()];
    slot.number.store(-1, std::memory_order_relaxed);
    for (std::size_t i = 0; i < slot.words.size(); ++i) {  // word by word: a copy of the whole row first costs 10 ns
      std::uint64_t word;
      std::memcpy(&word, reinterpret_cast<const char*>(&row) + i * sizeof word, sizeof word);
      slot.words[i].store(word, std::memory_order_release);
    }
    slot.number.store(number, std::memory_order_release);
  }

  /// False when that row is overwritten already (or being overwritten).
  bool recall(std::int64_t number, Row& row) const noexcept {
    const Slot& slot = slots_[static_cast<std::size_t>(number) % slots_.size()];
    if (slot.number.load(std::memory_order_acquire) != number) return false;
    Words words;
    for (std::size_t i = 0; i < words.size(); ++i) words[i] = slot.words[i].load(std::memory_order_acquire);
    if (slot.number.load(std::memory_order_relaxed) != number) return false;
    row = std::bit_cast<Row>(words);
    return true;
  }

 private:
  static_assert(std::is_trivially_copyable_v<Row> && sizeof(Row) % sizeof(std::uint64_t) == 0);
  using Words = std::array<std::uint64_t, sizeof(Row) / sizeof(std::uint64_t)>;
  struct Slot {
    std::atomic<std::int64_t> number{-1};
    std::array<std::atomic<std::uint64_t>, std::tuple_size_v<Words>> words{};
  };
  std::vector<Slot> slots_;
};

/// One producer (the loop), one consumer (the recording writer), wait-free on both sides. All memory is taken, and
/// touched, in the constructor.
///
/// The producer never is refused: a consumer that comes more than size() rows late has lost the oldest of them, which
/// is counted and marked. So the last size() cycles before a fault (or any other end) always reach the file.
class RecordingRing {
 public:
  static constexpr std::size_t default_rows = 16384;  ///< 3 s at 200 us: longer than a slow disk's sync

  explicit RecordingRing(std::size_t rows = default_rows) : last_(rows) {}
  RecordingRing(const RecordingRing&) = delete;
  RecordingRing& operator=(const RecordingRing&) = delete;

  /// HOT, producer.
  void push(const Row& row) noexcept {
    const std::int64_t number = pushed_.load(std::memory_order_relaxed);
    last_.keep(number, row);
    pushed_.store(number + 1, std::memory_order_release);
  }

  /// HOT, producer. Before the work of a tick: its row's memory comes into the cache meanwhile.
  void prefetch() const noexcept { last_.prefetch(pushed_.load(std::memory_order_relaxed)); }

  /// Consumer. The next row in the order of the pushes; false when there is none. Sets `row_dropped_before` on the
  /// first row after dropped ones.
  bool pop(Row& row) noexcept {
    for (;;) {
      const std::int64_t end = pushed_.load(std::memory_order_acquire);
      skip_to(end - static_cast<std::int64_t>(last_.size()));
      if (next_ >= end) return false;
      if (last_.recall(next_, row)) break;
      skip_to(next_ + 1);  // overwritten since
    }
    ++next_;
    if (gap_) row.flags |= row_dropped_before;
    gap_ = false;
    return true;
  }

  std::int64_t pushed() const noexcept { return pushed_.load(std::memory_order_acquire); }
  /// Rows that are lost: the consumer came too late for them.
  std::int64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  void skip_to(std::int64_t number) noexcept {
    if (number <= next_) return;
    dropped_.store(dropped_.load(std::memory_order_relaxed) + (number - next_), std::memory_order_relaxed);
    next_ = number;
    gap_ = true;
  }

  LastRows last_;
  std::atomic<std::int64_t> pushed_{0}, dropped_{0};
  // Consumer's own.
  bool gap_ = false;
  std::int64_t next_ = 0;
};

}  // namespace pneuservo
