// Syscall User Dispatch: every system call that a real-time section makes is recorded, then carried out.
#pragma once
#if !defined(PNEUSERVO_REALTIME_PROOF)
#error "compile with PNEUSERVO_REALTIME_PROOF (and what contains RtScope as well), else no section is ever watched"
#endif
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string>

#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/ucontext.h>

#include <pneuservo/core/rt.hpp>

namespace pneuservo {

/// Watches the RtScope sections of the calling thread while the object lives (x86-64, Linux 5.11 or later); reading the
/// clock through the vDSO is no call. After a trapped call the rest of that section runs unwatched: signal return is
/// a call itself. One object a thread.
class SyscallTrap {
 public:
  SyscallTrap() {
    syscall_selector = 0;
    count_ = 0;
    struct sigaction action{};
    action.sa_sigaction = on_trap;
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGSYS, &action, &previous_);
    if (prctl(set_user_dispatch, 1, 0UL, 0UL, &syscall_selector) != 0)
      throw std::runtime_error(std::string("Syscall User Dispatch: ") + std::strerror(errno));
  }
  ~SyscallTrap() {
    syscall_selector = 0;
    prctl(set_user_dispatch, 0, 0UL, 0UL, 0UL);
    sigaction(SIGSYS, &previous_, nullptr);
  }
  SyscallTrap(const SyscallTrap&) = delete;
  SyscallTrap& operator=(const SyscallTrap&) = delete;

  /// Trapped calls so far, at most one a section, and the numbers (asm/unistd_64.h) of the first 16.
  static int count() noexcept { return count_; }
  static int number(int index) noexcept { return numbers_[static_cast<std::size_t>(index)]; }

 private:
  static constexpr int set_user_dispatch = 59;  // PR_SET_SYSCALL_USER_DISPATCH

  // Steps back over the two bytes of the syscall instruction, so that the call is made again, now allowed.
  static void on_trap(int, siginfo_t* info, void* context) {
    syscall_selector = 0;
    const int index = count_;
    if (index < static_cast<int>(numbers_.size())) numbers_[static_cast<std::size_t>(index)] = info->si_syscall;
    count_ = index + 1;
    auto* machine = &static_cast<ucontext_t*>(context)->uc_mcontext;
    machine->gregs[REG_RIP] -= 2;
    machine->gregs[REG_RAX] = info->si_syscall;
  }

  constinit static inline thread_local volatile int count_ = 0;
  constinit static inline thread_local std::array<int, 16> numbers_{};
  struct sigaction previous_{};
};

}  // namespace pneuservo
