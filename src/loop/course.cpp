// The course of a run beside the pass itself.
#include "loop/course.hpp"

#include <algorithm>
#include <cmath>

namespace pneuservo {
double longest_start_s(const Rig& rig) noexcept {
  // A pressure rig has no approach: its reference begins with the first values of its inputs, or a fault comes.
  return rig.controls_pressure() ? Supervisor::first_value_ticks(rig.period_s) * rig.period_s
                                 : AxisLoop::longest_approach_s(rig.axis.cylinder.stroke_m);
}

Course::Course(const Rig& rig, int moves, std::size_t rows_kept)
    : period_s_(rig.period_s), duration_s_(rig.duration_s),
      planned_ticks_(std::max(rig.duration_s / rig.period_s * moves, 1.0)), wanted_moves_(moves) {
  if (moves == 0) return;
  const double most_s = static_cast<double>(moves) * (rig.duration_s + longest_start_s(rig)) + after_fault_s;
  const double most = std::min(most_s / rig.period_s + 16.0, static_cast<double>(rows_kept));
  rows_.resize(static_cast<std::size_t>(most));  // touches every page now, not in the loop
  moves_.resize(std::min(static_cast<std::size_t>(moves), moves_kept_max));
}

bool Course::after(std::int64_t tick, ControlLoop& loop) noexcept PNEUSERVO_NONBLOCKING {
  move_start_s_ = loop.reference_start_s();
  if (!rows_.empty()) {
    rows_[next_] = loop.row();
    if (++next_ == rows_.size()) next_ = 0;
  }
  ++count_;
  if (last_tick_ >= 0) overruns_ += tick - last_tick_ - 1;
  last_tick_ = tick;
  if (wanted_moves_ == 0) return true;
  if (loop.faults() != 0 && fault_tick_ < 0) fault_tick_ = tick;
  if (fault_tick_ >= 0) return static_cast<double>(tick - fault_tick_) * period_s_ < after_fault_s;
  // The last tick of a move is the one before its duration is over.
  if (loop.row().t_s - move_start_s_ + 1.5 * period_s_ < duration_s_) return true;
  close();
  if (closed_ >= wanted_moves_) return false;
  loop.restart_reference();
  return true;
}

void Course::close() noexcept {
  if (ended_rows_ == count_ || closed_ >= wanted_moves_) return;
  moves_[static_cast<std::size_t>(closed_) % moves_.size()] = {ended_rows_, count_, move_start_s_, overruns_};
  ++closed_;
  ended_rows_ = count_;
  overruns_ = 0;
}

std::int64_t Course::first_kept() const noexcept {
  return std::max<std::int64_t>(count_ - static_cast<std::int64_t>(rows_.size()), 0);
}

std::vector<MoveSpan> Course::moves() const {
  std::vector<MoveSpan> kept;
  const std::int64_t first_row = first_kept(), most = static_cast<std::int64_t>(moves_.size());
  for (std::int64_t i = std::max<std::int64_t>(closed_ - most, 0); i < closed_; ++i) {
    const Span& span = moves_[static_cast<std::size_t>(i % most)];
    if (span.end <= first_row) continue;
    const std::int64_t begin = std::max(span.begin, first_row);
    kept.push_back({static_cast<std::size_t>(begin - first_row), static_cast<std::size_t>(span.end - first_row),
                    span.start_s, span.overruns, static_cast<int>(i + 1),
                    static_cast<std::size_t>(begin - span.begin)});
  }
  return kept;
}

std::vector<Row> Course::take_rows() {
  if (count_ < static_cast<std::int64_t>(rows_.size())) rows_.resize(static_cast<std::size_t>(count_));
  else std::rotate(rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(next_), rows_.end());
  count_ = static_cast<std::int64_t>(rows_.size());
  return std::move(rows_);
}

}  // namespace pneuservo
