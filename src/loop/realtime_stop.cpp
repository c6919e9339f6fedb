// The wish to stop: an atomic flag set by the signal handler.
#include "loop/realtime_stop.hpp"

#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstring>
#include <initializer_list>
#include <limits>

#include <unistd.h>

#include "loop/realtime_clock.hpp"

namespace pneuservo {
namespace {

constexpr int asked_within_program = -1;
constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
/// Of the numbered signals, those whose usual effect is to end or to halt the program, crashes left out. The real-time
/// signals come on top.
constexpr std::array stop_signals{SIGHUP,  SIGINT,    SIGQUIT, SIGTERM, SIGTSTP, SIGUSR1, SIGUSR2,
                                  SIGALRM, SIGVTALRM, SIGPROF, SIGIO,   SIGPWR,  SIGXCPU, SIGSTKFLT};
/// They tell of a call that also fails, and the call's error is handled.
constexpr std::array ignored_signals{SIGXFSZ, SIGTTIN, SIGTTOU};

std::atomic<int> stop_reason{0};  // 0: none, else the signal's number
std::atomic<int> signals_seen{0}, living{0};
std::atomic<std::int64_t> held_until_ns{never};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free,
              "a signal handler may only use lock-free atomics");

std::array<struct sigaction, NSIG> actions_before{};
StopSignals chosen = StopSignals::every;

extern "C" void on_stop_signal(int number) {
  if (MonotonicClock::now_ns() > held_until_ns.load(std::memory_order_relaxed)) {
    signal(number, SIG_DFL);
    raise(number);
    return;
  }
  int no_reason = 0;
  stop_reason.compare_exchange_strong(no_reason, number, std::memory_order_relaxed);
  signals_seen.fetch_add(1, std::memory_order_relaxed);
}

/// Our own write to a reader that is gone brings SIGPIPE, too, and is no wish; the call's error is handled.
extern "C" void on_broken_pipe(int number, siginfo_t* info, void*) {
  if (info->si_pid != getpid()) on_stop_signal(number);
}

template <class Do> void for_each_signal(const Do& act) {
  if (chosen == StopSignals::interrupt_and_terminate) {
    for (const int number : {SIGINT, SIGTERM}) act(number, on_stop_signal);
    return;
  }
  for (const int number : stop_signals) act(number, on_stop_signal);
  for (int number = SIGRTMIN; number <= SIGRTMAX; ++number) act(number, on_stop_signal);
  for (const int number : ignored_signals) act(number, SIG_IGN);
  act(SIGPIPE, nullptr);
}

void install(int number, void (*handler)(int)) {
  struct sigaction action{};
  action.sa_handler = handler;
  if (number == SIGPIPE) {
    action.sa_sigaction = on_broken_pipe;
    action.sa_flags = SA_SIGINFO;
  }
  sigemptyset(&action.sa_mask);
  struct sigaction& was = actions_before[static_cast<std::size_t>(number)];
  sigaction(number, &action, &was);
  if (number == SIGHUP && was.sa_handler == SIG_IGN) signal(SIGHUP, SIG_IGN);
}

}  // namespace

StopRequest::StopRequest(StopSignals signals) {
  if (living.fetch_add(1) > 0) return;
  chosen = signals;
  stop_reason = 0;
  signals_seen = 0;
  held_until_ns = never;
  for_each_signal(install);
}

StopRequest::~StopRequest() {
  if (living.fetch_sub(1) > 1) return;
  for_each_signal(
      [](int number, auto) { sigaction(number, &actions_before[static_cast<std::size_t>(number)], nullptr); });
  stop_reason = 0;
}

bool StopRequest::requested() noexcept { return stop_reason.load(std::memory_order_relaxed) != 0; }

int StopRequest::signal_number() noexcept {
  const int reason = stop_reason.load(std::memory_order_relaxed);
  return reason == asked_within_program ? 0 : reason;
}

std::string StopRequest::signal_name() {
  const int number = signal_number();
  if (number == 0) return {};
  const char* const name = sigabbrev_np(number);
  return name != nullptr ? std::string("SIG") + name : "signal " + std::to_string(number);
}

int StopRequest::signals() noexcept { return signals_seen.load(std::memory_order_relaxed); }

void StopRequest::stop() noexcept {
  int no_reason = 0;
  stop_reason.compare_exchange_strong(no_reason, asked_within_program, std::memory_order_relaxed);
}

void StopRequest::let_go(double patience_s) noexcept {
  held_until_ns = MonotonicClock::now_ns() + std::llround(patience_s * 1e9);
}

void ignore_broken_pipes() noexcept { signal(SIGPIPE, SIG_IGN); }

}  // namespace pneuservo
