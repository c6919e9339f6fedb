// The command that a repeated move has learned: what its errors so far say is missing (docs/physics/command_pass.md).
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace pneuservo {

/// How far the learning of a repeated move has come.
struct LearningProgress {
  std::vector<double> error_rms_m;  ///< of each move that was judged, first one first
  std::size_t best = 0;             ///< of error_rms_m
  bool has_stopped = false;         ///< nothing is learned any more: the command of the best move stays
  int moves_not_learned = 0;        ///< because the loop was late in them
};

/// One command a tick, zero at first. After each move what its error asks for below 6 Hz is added, through the closed
/// loop's pulse response; a move that is worse than the first ends the learning, and so do three without a new best.
class RepeatedMove {
 public:
  /// The first resonance of 10 m of 7.65 mm, beyond which the model's phase is not sure. 4 to 10 Hz leave the same
  /// error within 0.03 mm, on eighty drawn machines.
  static constexpr double learned_Hz = 6.0;
  /// Part of the missing command that one move adds. It converges while the loop answers with less than 2/share of what
  /// the model says; 0.3 is too slow for five moves, 1.0 leaves as little as 0.6.
  static constexpr double share = 0.6;
  /// A convention: what it costs is three moves, for the best command is kept.
  static constexpr std::size_t patience_moves = 3;

  RepeatedMove() noexcept = default;
  /// response_m_per_V: position after a pulse of one period in the closed loop; window: 1 where the motion is, 0 where
  /// nothing is learned, a tick each; most_V: bound of the learned command; `identity` of reference and pass. Cold;
  /// allocates.
  RepeatedMove(std::vector<double> response_m_per_V, std::vector<double> window, double period_s, double most_V,
               std::uint64_t identity = 0);
  bool is_on() const noexcept { return is_on_; }
  /// What is learned holds for the same reference, beside the same pass.
  std::uint64_t identity() const noexcept { return identity_; }

  /// The learned command of a tick; 0 outside the move. HOT.
  double command_V(std::int64_t tick) const noexcept {
    return tick >= 0 && static_cast<std::size_t>(tick) < learned_V_.size() ? learned_V_[static_cast<std::size_t>(tick)]
                                                                           : 0.0;
  }
  /// Remembers the error of a tick of the move. HOT.
  void note(std::int64_t tick, double error_m) noexcept {
    if (tick >= 0 && static_cast<std::size_t>(tick) < error_m_.size())
      error_m_[static_cast<std::size_t>(tick)] = error_m;
  }
  /// After a move; not while a move goes on. Cold.
  void learn();

  /// What earlier runs of the same move learned; not while a move goes on. Cold.
  void begin_with(std::vector<double> learned_V);
  /// The command of the next move; of the best one where the learning has stopped.
  const std::vector<double>& learned_V() const noexcept { return learned_V_; }
  const LearningProgress& progress() const noexcept { return progress_; }

 private:
  double error_rms_m() const noexcept;

  std::vector<double> response_m_per_V_, window_;
  std::vector<double> learned_V_, best_V_, error_m_;
  double period_s_ = 1e-3, most_V_ = 0.0;
  std::uint64_t identity_ = 0;
  bool is_on_ = false;  ///< asked by the loop while another thread learns
  LearningProgress progress_;
};

/// What earlier runs learned of that move, a command a tick.
using LoadLearned = std::function<std::vector<double>(const RepeatedMove& move)>;

}  // namespace pneuservo
