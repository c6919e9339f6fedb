// Runs the loop on a backend in simulated or real time: approach, reference, moves, recording, safe end.
#pragma once
#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/control/repeated_move.hpp>
#include <pneuservo/hal/backend.hpp>
#include <pneuservo/loop/timing.hpp>
#include <pneuservo/record/row.hpp>
#include <pneuservo/rig/rig.hpp>

#include "loop/course.hpp"

namespace pneuservo {

class ControlLoop;
class FaultWatch;
class GainMailbox;
struct CommandLink;
class RecordingRing;
class RecordingWriter;

/// The first tick at or after `tick` comes `slots` periods late.
struct LateTick {
  std::int64_t tick = 0, slots = 0;
};

/// At the first tick at or after `tick` the machine comes back from so long a suspend.
struct Suspend {
  std::int64_t tick = 0, slept_ns = 0;
};

/// How a run goes.
struct RunSettings {
  /// Real time: the thread wakes this share of the period before its slot, at most longest_early_wake_s, and looks at
  /// the clock until the slot comes. A wake-up that is late by less no longer makes the tick late.
  static constexpr double early_wake_share = 0.05, longest_early_wake_s = 50e-6;
  static double usual_early_wake_s(double period_s) noexcept {
    return std::min(early_wake_share * period_s, longest_early_wake_s);
  }

  bool real_time = false;
  double early_wake_s = -1.0;  ///< 0: wakes at the slot; below 0: the usual share of the period
  int moves = 1;  ///< times the reference is run; 0: until a stop is asked for
  LoadPositions load{};  ///< references of kind `file`
  RecordingRing* ring = nullptr;  ///< real time: rows go here
  RecordingWriter* writer = nullptr;  ///< simulated time: rows go here
  FaultWatch* fault_watch = nullptr;  ///< the first fault is noted here
  std::string recording{};  ///< its path, for the last record of a crash
  /// What earlier runs of this move learned; called once with the law's move, where the law learns one.
  LoadLearned learned{};
  GainMailbox* gains = nullptr;  ///< gains for the running loop come from here
  CommandLink* commands = nullptr;  ///< whoever commands the axis; its reference is not run then
  std::function<void(const std::string&)> say{};  ///< why a commanded move has no pass; from another thread
  std::vector<LateTick> late{};  ///< injected: the loop comes so late, in order of their ticks
  std::vector<Suspend> suspends{};  ///< injected
  std::function<void(double fraction)> progress{};  ///< called between ticks in simulated time only
};

/// What came out.
struct RunOutcome {
  std::vector<Row> rows;  ///< the last ones, at most Course::rows_kept_max
  std::vector<MoveSpan> moves;  ///< those with rows
  std::int64_t moves_begun = 0;
  std::vector<std::string> faults;  ///< in words, first cause first; empty for a good run
  std::size_t first_faults = 0;  ///< so many of them came in the first tick: the reason
  double fault_s = 0.0;  ///< time of the first tick with a fault; meaningful with faults
  MotionLimits motion_limits;  ///< as they were in force
  bool stopped_by_signal = false;
  bool ended_by_backend = false;
  std::int64_t ticks = 0;  ///< served
  std::int64_t overruns = 0;  ///< slots skipped
  std::optional<RepeatedMove> repeated_move;  ///< what a law learned that learns a command
  int moves_not_learned = 0;  ///< too many of their slots were skipped to learn from them
  double wall_s = 0.0;
  std::unique_ptr<LoopTiming> timing;  ///< real time only
};

/// The configured loop of that kind of rig. `gains` and `commands` reach an axis alone; null: none.
std::unique_ptr<ControlLoop> make_control_loop(const Rig& rig, const LoadPositions& load, GainMailbox* gains,
                                               CommandLink* commands);

/// Runs `rig` on a configured backend: activates it, and however the run ends the safe output stands and the backend is
/// deactivated. In real time the caller holds the RealTimeSession. Throws what the backend's cold calls throw.
RunOutcome run_loop(const Rig& rig, Backend& backend, const RunSettings& settings);

/// Faults in words: name and meaning, first cause first.
std::vector<std::string> fault_words(std::uint64_t first, std::uint64_t all);

}  // namespace pneuservo
