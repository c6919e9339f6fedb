// Injected faults of the machine itself: leaks, lost supply, valve, hoses, what the slider carries and meets; for the
// backend sim and the simulated device.
#pragma once
#include <vector>

#include <pneuservo/hal/channel.hpp>
#include <pneuservo/rig/rig.hpp>

#include "rig/injected_fault.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {

/// Faults of other kinds are passed over. Whatever is not on has the config's value.
class PlantFaults {
 public:
  explicit PlantFaults(const Rig& rig);
  /// Cold.
  void add(const InjectedFault& fault) { faults_.push_back(fault); }
  /// What holds from time `t_s` on; before the plant goes on from there.
  void apply(double t_s, SimBackend& plant) noexcept;
  /// What the valve does when it is given `asked`.
  Command command(double t_s, const Command& asked) noexcept;

 private:
  void apply_to_slider(double t_s, SimBackend& plant) noexcept;

  Rig rig_;  // with its deviations
  std::vector<InjectedFault> faults_;
  Command last_;
  bool changed_ = false, slider_changed_ = false, between_stops_ = false;
};

}  // namespace pneuservo
