// What drives passes sees of a control loop, whatever it controls.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

#include <pneuservo/control/axis_controller.hpp>
#include <pneuservo/core/rt.hpp>
#include <pneuservo/hal/backend.hpp>
#include <pneuservo/loop/axis_command.hpp>
#include <pneuservo/loop/supervisor.hpp>
#include <pneuservo/record/row.hpp>

namespace pneuservo {

/// Times of the stages of one pass [ns of the given clock].
struct StageTimes {
  std::int64_t start = 0, read = 0, estimated = 0, controlled = 0, written = 0, end = 0;
};

/// A loop on one backend; LoopPass has the meaning of each. The passes are HOT.
class ControlLoop {
 public:
  virtual ~ControlLoop() = default;

  virtual bool pass(Backend& backend, std::int64_t tick, std::int64_t skipped, StageTimes* times,
                    std::int64_t (*now)() noexcept) noexcept PNEUSERVO_NONBLOCKING = 0;
  virtual void stop(Backend& backend, std::int64_t tick) noexcept = 0;
  virtual void restart_reference() noexcept = 0;
  virtual void note_slept(std::int64_t slept_ns) noexcept = 0;
  /// Whoever commands it (reference of kind `live`); null: it runs its reference. Before the first pass. What is
  /// commanded moves after the command `enable` alone, which is lost with each fault, and rests where it is.
  virtual void set_command_link(CommandLink* link) noexcept = 0;
  virtual bool learning_due() const noexcept { return false; }
  virtual void learn(const AxisParameters<double>&) {}
  /// A move waits for its command pass, which make_pass() makes: by one thread only, beside passes of the loop if need
  /// be. Returns why there is none, in a sentence; empty: there is one, or nobody waits any more. Cold.
  virtual bool makes_passes() const noexcept { return false; }
  virtual bool pass_due() const noexcept { return false; }
  virtual std::string make_pass() { return {}; }
  /// Tick before which it must be there.
  virtual std::int64_t pass_needed_tick() const noexcept { return 0; }
  /// Begins with what earlier runs of the law's move learned, where it learns one; before the first pass. Cold.
  virtual void begin_with_learned(const LoadLearned&) {}

  virtual const Row& row() const noexcept = 0;
  virtual Row& row() noexcept = 0;
  virtual std::uint64_t faults() const noexcept = 0;
  virtual std::uint64_t first_faults() const noexcept = 0;
  virtual double reference_start_s() const noexcept = 0;
  virtual const Supervisor& supervisor() const noexcept = 0;
  virtual const AxisController& controller() const noexcept = 0;
  /// Of the object itself, to bring it into the cache.
  virtual std::size_t size() const noexcept = 0;
};

}  // namespace pneuservo
