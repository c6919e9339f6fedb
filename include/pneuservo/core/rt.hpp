// Marks of the real-time section: nothing in ordinary builds, the hooks of the proof tools in tests/realtime.
#pragma once

// Attribute of functions that neither block nor allocate; stands after noexcept. clang-tidy 20 (tools/check-realtime)
// proves it through the whole call tree; g++ and older clang do not know it.
#if defined(__clang__) && __clang_major__ >= 20
#define PNEUSERVO_NONBLOCKING [[clang::nonblocking]]
#else
#define PNEUSERVO_NONBLOCKING
#endif

#if defined(PNEUSERVO_REALTIME_PROOF)
// NOLINTBEGIN(bugprone-reserved-identifier): names of the sanitizer's runtime, empty where a program does without it
extern "C" {
void __rtsan_realtime_enter();
void __rtsan_realtime_exit();
void __rtsan_off();
void __rtsan_on();
}
// NOLINTEND(bugprone-reserved-identifier)
#endif

namespace pneuservo {

#if defined(PNEUSERVO_REALTIME_PROOF)

// Another name for the linker than the empty classes of an ordinary build, so that both may meet in one program.
inline namespace rt_proof {

/// Selector byte of Syscall User Dispatch (prctl(2)): 0 lets system calls pass, 1 traps them. A harness that armed the
/// dispatch on this byte (tests/realtime/syscall_trap.hpp) sees every system call of this thread's real-time section.
constinit inline thread_local volatile char syscall_selector = 0;

/// Around one step of the loop.
class RtScope {
 public:
  RtScope() noexcept : previous_(syscall_selector) {
    __rtsan_realtime_enter();
    syscall_selector = 1;
  }
  ~RtScope() {
    syscall_selector = previous_;
    __rtsan_realtime_exit();
  }
  RtScope(const RtScope&) = delete;
  RtScope& operator=(const RtScope&) = delete;

 private:
  char previous_;
};

/// Around a reviewed exception inside the section, such as a non-blocking send on a bus.
class RtAllow {
 public:
  RtAllow() noexcept : previous_(syscall_selector) {
    syscall_selector = 0;
    __rtsan_off();
  }
  ~RtAllow() {
    __rtsan_on();
    syscall_selector = previous_;
  }
  RtAllow(const RtAllow&) = delete;
  RtAllow& operator=(const RtAllow&) = delete;

 private:
  char previous_;
};

}  // namespace rt_proof

#else

// NOLINTBEGIN(modernize-use-equals-default): a trivial guard would be an unused variable
/// Around one step of the loop.
class RtScope {
 public:
  RtScope() noexcept {}
  ~RtScope() {}
  RtScope(const RtScope&) = delete;
  RtScope& operator=(const RtScope&) = delete;
};

/// Around a reviewed exception inside the section, such as a non-blocking send on a bus.
class RtAllow {
 public:
  RtAllow() noexcept {}
  ~RtAllow() {}
  RtAllow(const RtAllow&) = delete;
  RtAllow& operator=(const RtAllow&) = delete;
};
// NOLINTEND(modernize-use-equals-default)

#endif

}  // namespace pneuservo
