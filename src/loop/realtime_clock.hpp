// The clock of real time, the thread's fault counters, and memory that is touched before it is needed.
#pragma once
#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <ctime>

#include <sys/resource.h>

namespace pneuservo {

/// Tells the processor that this is a waiting loop.
inline void pause_processor() noexcept {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// CLOCK_MONOTONIC: reading it is no system call (vDSO), sleeping is to an absolute time, so that a late wake-up does
/// not move the next one.
struct MonotonicClock {
  static std::int64_t now_ns() noexcept {
    timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
  }
  /// Returns at `time_ns` or later, at once if it is past; a signal does not cut the sleep short.
  static void sleep_until_ns(std::int64_t time_ns) noexcept {
    const timespec until{static_cast<time_t>(time_ns / 1'000'000'000), static_cast<long>(time_ns % 1'000'000'000)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {}
  }
  /// Looks at the clock until `time_ns`; returns at once if it is past.
  static void spin_until_ns(std::int64_t time_ns) noexcept {
    while (now_ns() < time_ns) pause_processor();
  }
};

/// Suspends of the machine: CLOCK_BOOTTIME goes on in them, CLOCK_MONOTONIC stands, so no tick is late after one. Both
/// are read without a system call (vDSO).
class SuspendWatch {
 public:
  /// HOT. Time slept since the first call, never more than the truth [ns]; `now_ns`: CLOCK_MONOTONIC, read before. A
  /// reading that was preempted in between proves nothing, so a rise is believed only with a second one behind it.
  std::int64_t slept_ns(std::int64_t now_ns) noexcept {
    const std::int64_t boot_ns = boot_now_ns(), at_most_ns = boot_ns - now_ns;
    if (first_) difference_ns_ = at_most_ns, first_ = false;
    if (at_most_ns <= difference_ns_ + slept_ns_) return slept_ns_;
    const std::int64_t at_least_ns = boot_ns - MonotonicClock::now_ns();
    return slept_ns_ = std::max(slept_ns_, at_least_ns - difference_ns_);
  }

 private:
  static std::int64_t boot_now_ns() noexcept {
    timespec now;
    clock_gettime(CLOCK_BOOTTIME, &now);
    return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
  }
  bool first_ = true;
  std::int64_t difference_ns_ = 0, slept_ns_ = 0;
};

/// What the kernel counts against a real-time thread.
struct ThreadCounters {
  std::int64_t page_faults = 0;                   ///< minor and major
  std::int64_t context_switches_involuntary = 0;  ///< preempted while it had work

  /// Of the calling thread since its start; a system call: before and after the loop, not in a tick.
  static ThreadCounters now() noexcept {
    rusage usage{};
    getrusage(RUSAGE_THREAD, &usage);
    return {usage.ru_minflt + usage.ru_majflt, usage.ru_nivcsw};
  }
  friend ThreadCounters operator-(const ThreadCounters& a, const ThreadCounters& b) noexcept {
    return {a.page_faults - b.page_faults, a.context_switches_involuntary - b.context_switches_involuntary};
  }
};

/// Writes to every page of [memory, memory + bytes) without changing it, so that the loop never is the first to touch.
void prefault(void* memory, std::size_t bytes) noexcept;
/// HOT. Reads [memory, memory + bytes) once, so that it is in the cache when the tick begins.
inline void warm(const void* memory, std::size_t bytes) noexcept {
  const auto* const at = static_cast<const char*>(memory);
  for (std::size_t offset = 0; offset < bytes; offset += 64) __builtin_prefetch(at + offset, 1);
}
/// Touches `bytes` of the calling thread's stack below the caller's frame.
void prefault_stack(std::size_t bytes) noexcept;

}  // namespace pneuservo
