// One watch over a repeated step: system calls, allocations, page faults and preemptions after the warm-up.
#pragma once
#include <cstdio>
#include <string>

#include "allocation_guard.hpp"
#include "loop/realtime_clock.hpp"
#include "syscall_trap.hpp"

namespace pneuservo {

struct StepGuardReport {
  int system_calls = 0;
  int first_system_call = -1;
  long allocations = 0;
  ThreadCounters counters;

  /// What was caught, one phrase each; empty if nothing. Preemptions are told apart: they are the machine's doing.
  std::string violations() const {
    std::string text;
    if (system_calls > 0) text += "system call " + std::to_string(first_system_call) + " in the real-time section; ";
    if (allocations > 0) text += std::to_string(allocations) + " allocation calls in the real-time section; ";
    if (counters.page_faults > 1) text += std::to_string(counters.page_faults) + " page faults in the real-time section; ";
    return text;
  }
};

/// Runs `step` (which holds an RtScope) `warm_up` times unwatched and `count` times watched. One page fault is allowed.
template <class Step> StepGuardReport guard_steps(Step&& step, int warm_up, int count) {
  for (int i = 0; i < warm_up; ++i) step();
  const SyscallTrap trap;
  const ThreadCounters before = ThreadCounters::now();
  const long allocations_before = allocation_calls();
  for (int i = 0; i < count; ++i) step();
  StepGuardReport report;
  report.allocations = allocation_calls() - allocations_before;
  report.counters = ThreadCounters::now() - before;
  report.system_calls = SyscallTrap::count();
  if (report.system_calls > 0) report.first_system_call = SyscallTrap::number(0);
  return report;
}

}  // namespace pneuservo
