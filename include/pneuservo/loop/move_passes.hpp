// The way of command passes for moves that come at run time: asked for in a tick, made beside the loop, taken when the
// move begins.
#pragma once
#include <atomic>
#include <cstdint>
#include <vector>

#include <pneuservo/control/pass_table.hpp>
#include <pneuservo/loop/commanded_motion.hpp>
#include <pneuservo/loop/mailbox.hpp>

namespace pneuservo {

/// What a pass is asked for.
struct MovePassRequest {
  PlannedMove move;
  double pressure_1_Pa = 0.0;  ///< of chamber 1 while the axis waits
};

/// From the move's first tick on; without ticks there is none.
struct MovePass {
  std::uint64_t number = 0;  ///< of the planned move
  std::vector<PassTick> law, prediction;
};

/// The loop asks and takes, another thread makes; neither waits. The newest request counts, and a pass that comes after
/// its move has begun is never taken.
class MovePasses {
 public:
  // In the loop; HOT.
  void request(const MovePassRequest& request) noexcept { requests_.post(request); }
  /// Once for a move, when it begins; null: there is no pass of it. What was taken before lasts no longer.
  const MovePass* take(std::uint64_t number) noexcept {
    const MovePass* pass = passes_.take();
    const bool is_made = pass != nullptr && pass->number == number;
    if (!is_made) missed_.store(number, std::memory_order_relaxed);
    over_.store(number, std::memory_order_relaxed);
    return is_made && !pass->law.empty() ? pass : nullptr;
  }
  /// Nobody waits for the pass of this move or of an earlier one any more.
  void drop(std::uint64_t number) noexcept { over_.store(number, std::memory_order_relaxed); }

  // Beside it.
  bool is_due() const noexcept { return requests_.has_new(); }
  bool take_request(MovePassRequest& request) noexcept { return requests_.take(request); }
  /// Whether somebody still waits for the pass of this move.
  bool is_awaited(std::uint64_t number) const noexcept {
    return !requests_.has_new() && over_.load(std::memory_order_relaxed) < number;
  }
  /// Whether this move began before its pass was there.
  bool was_missed(std::uint64_t number) const noexcept { return missed_.load(std::memory_order_relaxed) == number; }
  MovePass& draft() noexcept { return passes_.draft(); }
  void post_draft() noexcept { passes_.post_draft(); }

 private:
  Mailbox<MovePassRequest> requests_;
  Mailbox<MovePass> passes_;
  std::atomic<std::uint64_t> over_{0}, missed_{0};
};

}  // namespace pneuservo
