// The one interface of all backends: configure, activate, read, write, deactivate.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <pneuservo/hal/channel.hpp>

namespace pneuservo {

/// What is known of the safe output after a fault or the end of a run. A tick of -1: has not happened.
struct SafeOutput {
  bool has_outputs = false;           ///< the backend has any
  bool is_simulated = false;          ///< in memory alone: sent is there
  bool is_read_back = false;          ///< each output is
  std::int64_t sent_tick = -1;        ///< handed over to all devices
  std::int64_t confirmed_tick = -1;   ///< all outputs were read back as the safe ones
  std::int64_t stop_tick = -1;        ///< devices whose readback showed another output were told to stop
  std::int64_t substitute_tick = -1;  ///< all devices with outputs said that they miss us or are stopped
};

/// The devices' newest sampling instant.
struct Pace {
  std::int64_t samples = 0;  ///< periods since the one before; 0: none came in time
  std::int64_t at_ns = 0;    ///< when its inputs were there, CLOCK_MONOTONIC
};

/// A rig's hardware, real or simulated. The cold calls may allocate, block and throw std::runtime_error with one clear
/// sentence; read and write are called in the real-time loop: no allocation, no lock, no throw, no blocking call.
class Backend {
 public:
  virtual ~Backend() = default;

  /// Opens and checks the devices; outputs stay as they are.
  virtual void configure() = 0;
  /// Takes control of the outputs; from here on read and write are called every tick.
  virtual void activate() = 0;
  /// The devices sample by a clock of their own: each tick begins with await_sample.
  virtual bool is_paced() const noexcept { return false; }
  /// Blocks until the inputs of the next sampling instant are there or the time for it is over, which is a fault.
  virtual Pace await_sample() noexcept { return {}; }
  /// Samples all channels for tick `tick`. False: the backend has ended (a replay ran out of rows).
  virtual bool read(std::int64_t tick, Measurement& measurement) noexcept = 0;
  /// Applies the command from the sampling instant of `tick` on. False: the output was missed.
  virtual bool write(std::int64_t tick, const Command& command) noexcept = 0;
  /// Puts the outputs into the declared safe state and releases the devices; may be called twice.
  virtual void deactivate() noexcept = 0;
  /// The program crashed: the safe output once more, with nothing but what a handler of signals may call. False: a
  /// device refused it. Backends without devices have nothing to do.
  virtual bool emergency_write() noexcept { return true; }

  /// What the simulated plant really does; absent (NaN) for real hardware. Never reaches estimator or controller.
  virtual Truth truth() const noexcept { return {}; }
  /// Known once configured.
  virtual Origins origins() const = 0;
  /// Since the first write with `ended`. Cold.
  virtual SafeOutput safe_output() const { return {}; }
  /// What happened on the devices, one sentence each, for the user after a run. Cold.
  virtual std::vector<std::string> notes() const { return {}; }
  virtual std::string name() const = 0;
};

}  // namespace pneuservo
