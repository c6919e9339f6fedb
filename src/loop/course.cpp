// The course of a run beside the pass itself.
#include "loop/course.hpp"

#include <cmath>

namespace pneuservo {
Course::Course(const Rig& rig, int moves)
    : period_s_(rig.period_s), duration_s_(rig.duration_s), wanted_moves_(static_cast<std::size_t>(moves)),
      planned_ticks_(std::llround(rig.duration_s / rig.period_s) * moves) {
  const double most_s =
      static_cast<double>(moves) * (rig.duration_s + AxisLoop::longest_approach_s(rig.axis.cylinder.stroke_m)) +
      after_fault_s;
  rows_.resize(static_cast<std::size_t>(most_s / rig.period_s) + 16);  // touches every page now, not in the loop
  moves_.resize(wanted_moves_);
}

bool Course::after(std::int64_t tick, AxisLoop& loop) noexcept PNEUSERVO_NONBLOCKING {
  move_start_s_ = loop.reference_start_s();
  if (kept_ < rows_.size()) rows_[kept_++] = loop.row();
  if (last_tick_ >= 0) overruns_ += tick - last_tick_ - 1;
  last_tick_ = tick;
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
  if (ended_rows_ == kept_ || closed_ >= wanted_moves_) return;
  moves_[closed_++] = {ended_rows_, kept_, move_start_s_, overruns_};
  ended_rows_ = kept_;
  overruns_ = 0;
}

}  // namespace pneuservo
