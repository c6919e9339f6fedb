// The course of a run beside the pass itself: moves one after another, the time after a fault, the rows kept.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/record/row.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// One move of a run: rows [begin, end), its reference's time 0 at start_s; `overruns`: slots skipped in it.
struct MoveSpan {
  std::size_t begin = 0, end = 0;
  double start_s = 0.0;
  std::int64_t overruns = 0;
};

/// Decides after every pass whether the run goes on; the same for runs and replays, so that a replay restarts the
/// reference at the tick at which the run did. All memory is taken and touched in the constructor: a row and a move are
/// written into what is there.
class Course {
 public:
  /// After a fault the axis stays in its safe output this long before the run ends, so that the recording shows it.
  static constexpr double after_fault_s = 0.3;

  Course(const Rig& rig, int moves);
  /// After the pass of `tick`; false: the run is over. Keeps the row. HOT.
  bool after(std::int64_t tick, AxisLoop& loop) noexcept PNEUSERVO_NONBLOCKING;
  /// HOT. Before the work of a tick: its row's memory comes into the cache meanwhile.
  void prefetch() const noexcept {
    if (kept_ >= rows_.size()) return;
    const auto* const row = reinterpret_cast<const char*>(&rows_[kept_]);
    for (std::size_t offset = 0; offset <= sizeof(Row); offset += 64) __builtin_prefetch(row + offset, 1);
  }
  /// Ends the move that is under way.
  void close() noexcept;
  /// Share of the run that is done, about.
  double fraction(std::int64_t tick) const noexcept {
    return static_cast<double>(tick) / static_cast<double>(planned_ticks_);
  }

  /// Tick of the first fault; -1: none.
  std::int64_t fault_tick() const noexcept { return fault_tick_; }
  /// Moves begun so far; cold, after the run.
  std::vector<MoveSpan> moves() const {
    return {moves_.begin(), moves_.begin() + static_cast<std::ptrdiff_t>(closed_)};
  }
  /// The rows; cold, once, after the run.
  std::vector<Row> take_rows() {
    rows_.resize(kept_);
    return std::move(rows_);
  }

 private:
  double period_s_, duration_s_;
  std::size_t wanted_moves_;
  std::int64_t planned_ticks_, fault_tick_ = -1, last_tick_ = -1, overruns_ = 0;
  double move_start_s_ = 0.0;
  std::vector<Row> rows_;
  std::vector<MoveSpan> moves_;
  std::size_t kept_ = 0, closed_ = 0, ended_rows_ = 0;
};

}  // namespace pneuservo
