// The motions of the commissioning: rest and probes, limited and recorded; no judgement but that which ends a probe.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <pneuservo/hal/channel.hpp>
#include <pneuservo/rig/rig.hpp>

#include "loop/supervised_steps.hpp"

namespace pneuservo {

/// Means over the end of a rest, of raw samples.
struct RestState {
  PerSignal<double> mean{}, rms{};
  PerSignal<std::int64_t> count{}, bad{};
  double drift_mps = 0.0, from_m = 0.0, to_m = 0.0;  ///< of the position: slope of the end, range of all of it
  std::array<double, 2> port_Pa() const noexcept { return {mean[Signal::p1_port], mean[Signal::p2_port]}; }
};

enum class ProbeEnd {
  moved,     ///< measured way_m
  too_fast,
  pushed,    ///< the air pushes a slider that stands
  unseen,    ///< the air flows and neither moves the slider nor pushes
  little,    ///< moved, but less than the air should have moved it
  no_answer  ///< the whole range of commands without an answer
};

/// One pulse of the command to one side, from rest, until something ended its ramp.
struct Probe {
  int direction = 1;
  RestState before, after;
  double ramp_V_per_s = 0.0;
  std::vector<double> position_m;           ///< tick by tick from the first one of the ramp until it has settled
  std::vector<double> volts;                ///< in force from that tick on, its size alone
  std::vector<std::array<double, 2>> port_Pa, chamber_Pa;
  ProbeEnd end = ProbeEnd::no_answer;
  double end_V = 0.0, moved_m = 0.0, farthest_m = 0.0, fastest_mps = 0.0, force_change_N = 0.0;
};

/// Rests with the valve closed until the slider stands, `shortest_s` at least.
RestState rest(SupervisedSteps& steps, double shortest_s);
/// Ramps the command to one side (+1 fills side 1) within ProbeLimits, closes the valve over one period of the slider
/// on its air, which leaves no swing behind, and rests.
Probe probe(const Rig& rig, SupervisedSteps& steps, int direction, const RestState& before);

}  // namespace pneuservo
