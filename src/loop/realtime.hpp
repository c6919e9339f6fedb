// A thread in real time: what the kernel is asked for, what it granted, and how everything is put back.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include <sched.h>

#include "loop/finding.hpp"

namespace pneuservo {

/// What the calling thread shall get.
struct RealTimeSettings {
  int priority = 80;       ///< of SCHED_FIFO, 1..99; above the interrupt threads' 50
  std::optional<int> cpu;  ///< pins the thread; none: any processor
  std::size_t stack_bytes = std::size_t{512} * 1024;  ///< touched in advance
};

/// What it has, for the recording's header and the reports.
struct RealTimeState {
  std::string kernel;            ///< release of the running kernel
  bool preempt_rt = false;       ///< the kernel is PREEMPT_RT: lateness is bounded
  std::string policy;            ///< "SCHED_FIFO" or "SCHED_OTHER"
  int priority = 0;              ///< 0 for SCHED_OTHER
  bool memory_locked = false;    ///< present and future pages stay in memory
  bool cpu_latency_held = false; ///< /dev/cpu_dma_latency held at 0: no deep sleep states
  std::optional<int> cpu;        ///< pinned to this processor
};

/// Makes the calling thread a real-time thread while the object lives: malloc keeps its memory, pages locked, stack
/// touched, SCHED_FIFO, affinity, sleep states off; the destructor (same thread) restores what it found. What the
/// system refuses is no error but a finding with its remedy: the loop still runs, only later. Threads created meanwhile
/// start as ordinary ones.
class RealTimeSession {
 public:
  explicit RealTimeSession(const RealTimeSettings& settings = {});
  ~RealTimeSession();
  RealTimeSession(const RealTimeSession&) = delete;
  RealTimeSession& operator=(const RealTimeSession&) = delete;

  /// What was refused; empty if everything was granted.
  const std::vector<Finding>& findings() const { return findings_; }
  const RealTimeState& state() const { return state_; }

 private:
  void keep_heap();
  void lock_memory();
  void hold_cpu_latency();
  void pin(int cpu);
  void raise_priority(int priority);
  void refuse(FindingLevel level, std::string topic, std::string what, std::string remedy);

  std::vector<Finding> findings_;
  RealTimeState state_;
  int latency_file_ = -1;
  int previous_policy_ = SCHED_OTHER;
  sched_param previous_parameters_{};
  cpu_set_t previous_cpus_{};
  unsigned long previous_timer_slack_ns_ = 50'000;
};

/// The findings as they are said once before a run: one line what, one line remedy; empty text for none.
std::string refusal_message(const std::vector<Finding>& findings);

/// True if the running kernel is PREEMPT_RT.
bool kernel_is_preempt_rt();

}  // namespace pneuservo
