// The one cold engine of the named steps before the first motion: reads, judges, commands and ends in the safe output.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/loop/grid.hpp>
#include <pneuservo/loop/supervisor.hpp>
#include <pneuservo/rig/rig.hpp>

#include "loop/last_resort.hpp"

namespace pneuservo {

/// One tick of a step: `raw` as it came, `in` as it was judged (NaN before the first good sample).
struct StepSample {
  std::int64_t tick = 0, skipped = 0;
  double t_s = 0.0;  ///< since the step began
  Measurement raw;
  JudgedInputs in;
};

/// What a step sends, and whether it is done with this tick.
struct StepAnswer {
  Command command;
  bool done = false;
};

/// An axis that is moved by steps one after another on one grid of time, so that a device's watchdog sees no gap. The
/// safe output stands at the end, however it comes.
class SupervisedSteps {
 public:
  /// Activates the backend. `name` begins every sentence that is thrown; `passed_over`: faults that do not end a step.
  SupervisedSteps(const Rig& rig, Backend& backend, std::string name, bool real_time, std::uint64_t passed_over);
  ~SupervisedSteps();
  SupervisedSteps(const SupervisedSteps&) = delete;
  SupervisedSteps& operator=(const SupervisedSteps&) = delete;

  /// Calls `step` once a period and sends what it answers, until it is done. Throws std::runtime_error on a fault, a
  /// lost output, an ended backend, or a signal.
  void run(const std::function<StepAnswer(const StepSample&)>& step);
  /// `volts` beyond the closing command; of a pair of valves the second one the other way.
  Command command(double volts) const noexcept;
  /// The declared safe output, not enabled.
  Command safe() const noexcept;
  /// From here on only these faults do not end a step; what was found before is forgotten.
  void judge_anew(std::uint64_t passed_over) noexcept {
    passed_over_ = passed_over;
    supervisor_.rearm();
  }
  std::uint64_t faults() const noexcept { return supervisor_.faults(); }

 private:
  [[noreturn]] void refuse(const std::string& why) const;
  void wait_for_slot();

  const Rig& rig_;
  Backend& backend_;
  std::string name_;
  bool real_time_;
  std::uint64_t passed_over_;
  Supervisor supervisor_;
  LastResort last_resort_;
  std::unique_ptr<TimeGrid> grid_;
  std::int64_t tick_ = 0, skipped_ = 0;
};

}  // namespace pneuservo
