// What the helping threads beside the loop are.
#include "record/ordinary_thread.hpp"

#include <csignal>
#include <initializer_list>

#include <pthread.h>

namespace pneuservo {

void become_ordinary_thread(const char* name) noexcept {
  sigset_t blocked;
  sigfillset(&blocked);
  // Blocked, these would end the program at once, past the handler that gives the safe output.
  for (const int crash : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) sigdelset(&blocked, crash);
  pthread_sigmask(SIG_BLOCK, &blocked, nullptr);
  const sched_param parameters{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &parameters);
  pthread_setname_np(pthread_self(), name);
}

}  // namespace pneuservo
