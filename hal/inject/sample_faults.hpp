// Injected faults of the sensors and their wires: what a channel shows instead of its sample; for the backend sim and
// the simulated device.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include <pneuservo/hal/channel.hpp>

#include "rig/injected_fault.hpp"

namespace pneuservo {

/// Faults of other kinds are passed over. Those of one channel act in the order in which they were added.
class SampleFaults {
 public:
  /// `far_out`: what a saturated channel shows unless its fault states a value, by signal.
  SampleFaults(double period_s, const PerSignal<double>& far_out);
  /// Cold.
  void add(const InjectedFault& fault);
  /// As if nothing had been sampled yet. Cold.
  void reset();
  /// Spoils the samples of a tick, whose time is `t_s`; once a tick.
  void apply(std::int64_t tick, double t_s, Measurement& measured) noexcept;

 private:
  struct Spoiled {
    InjectedFault fault;
    Signal signal;
    std::optional<double> kept;  ///< what a frozen channel repeats
    bool spent = false;
    std::int64_t count = 0;  ///< samples since it is on
  };
  void remember(std::int64_t tick, const Measurement& measured) noexcept;
  void rewire(double t_s, Measurement& measured) const noexcept;
  void spoil(Spoiled& spoiled, Channel& sample) noexcept;
  void delay(double delay_s, Signal signal, Channel& sample) const noexcept;

  double period_s_;
  PerSignal<double> far_out_;
  std::vector<Spoiled> faults_;
  std::vector<InjectedFault> wiring_;
  std::vector<PerSignal<double>> history_;  // ring of what was measured, a slot a tick
  std::size_t newest_ = 0;
  std::optional<std::int64_t> newest_tick_;
  PerSignal<double> shown_;  // in the last tick, faults included
};

}  // namespace pneuservo
