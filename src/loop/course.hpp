// The course of a run beside the pass itself: moves one after another, the time after a fault, the last rows.
#pragma once
#include <cstdint>
#include <vector>

#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/record/row.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// One move of a run: its rows [begin, end) among those kept, its reference's time 0 at start_s; `overruns`: slots
/// skipped in it.
struct MoveSpan {
  std::size_t begin = 0, end = 0;
  double start_s = 0.0;
  std::int64_t overruns = 0;
  int number = 1;  ///< counts from 1
  std::size_t rows_lost = 0;  ///< at its beginning, older than what was kept
};

/// Longest time of a move before its reference begins.
double longest_start_s(const Rig& rig) noexcept;

/// Decides after every pass whether the run goes on; the same for runs and replays, so that a replay restarts the
/// reference at the tick at which the run did. All memory is taken and touched in the constructor and does not grow
/// with the run: the last rows and moves are kept, newest over oldest. The recording has all of them.
class Course {
 public:
  /// After a fault the axis stays in its safe output this long before the run ends, so that the recording shows it.
  static constexpr double after_fault_s = 0.3;
  /// 64 MB of locked memory, 262 s at 1 ms and 52 s at 200 us: five times the longest run of the shipped configs.
  static constexpr std::size_t rows_kept_max = std::size_t{1} << 18;
  /// More than a page or a table can show; 0.2 MB.
  static constexpr std::size_t moves_kept_max = 4096;

  /// `rows_kept`: so many of the last rows are kept at most. `moves` 0: commanded, goes on for ever and keeps no rows.
  Course(const Rig& rig, int moves, std::size_t rows_kept = rows_kept_max);
  /// After the pass of `tick`; false: the run is over. Keeps the row. HOT.
  bool after(std::int64_t tick, ControlLoop& loop) noexcept PNEUSERVO_NONBLOCKING;
  /// HOT. Before the work of a tick: its row's memory comes into the cache meanwhile.
  void prefetch() const noexcept {
    if (rows_.empty()) return;
    const auto* const row = reinterpret_cast<const char*>(&rows_[next_]);
    for (std::size_t offset = 0; offset <= sizeof(Row); offset += 64) __builtin_prefetch(row + offset, 1);
  }
  /// Ends the move that is under way.
  void close() noexcept;
  /// Share of the run that is done, about.
  double fraction(std::int64_t tick) const noexcept { return static_cast<double>(tick) / planned_ticks_; }

  /// Tick of the first fault; -1: none.
  std::int64_t fault_tick() const noexcept { return fault_tick_; }
  /// Moves begun so far of which a row is kept, in their order; cold, after the run.
  std::vector<MoveSpan> moves() const;
  /// Moves begun so far.
  std::int64_t moves_begun() const noexcept { return closed_; }
  /// The rows that are kept, in the order of time; cold, once, after the run.
  std::vector<Row> take_rows();

 private:
  struct Span {
    std::int64_t begin = 0, end = 0;  // among all rows of the run
    double start_s = 0.0;
    std::int64_t overruns = 0;
  };
  std::int64_t first_kept() const noexcept;

  double period_s_, duration_s_, planned_ticks_;
  std::int64_t wanted_moves_, fault_tick_ = -1, last_tick_ = -1, overruns_ = 0;
  double move_start_s_ = 0.0;
  std::vector<Row> rows_;
  std::vector<Span> moves_;
  std::size_t next_ = 0;  // place of the next row
  std::int64_t count_ = 0, closed_ = 0, ended_rows_ = 0;
};

}  // namespace pneuservo
