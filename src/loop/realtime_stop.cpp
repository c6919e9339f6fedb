// The wish to stop: an atomic flag set by the signal handler.
#include "loop/realtime_stop.hpp"

#include <atomic>
#include <stdexcept>

namespace pneuservo {
namespace {

constexpr int asked_within_program = -1;
std::atomic<int> stop_reason{0};  // 0: none, else the signal's number
std::atomic<bool> installed{false};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may only use lock-free atomics");

extern "C" void on_stop_signal(int number) {
  int none = 0;
  stop_reason.compare_exchange_strong(none, number, std::memory_order_relaxed);
}

}  // namespace

StopRequest::StopRequest() {
  if (installed.exchange(true)) throw std::logic_error("a second StopRequest was created while one is alive");
  stop_reason = 0;
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &previous_interrupt_);
  sigaction(SIGTERM, &action, &previous_terminate_);
}

StopRequest::~StopRequest() {
  sigaction(SIGINT, &previous_interrupt_, nullptr);
  sigaction(SIGTERM, &previous_terminate_, nullptr);
  stop_reason = 0;
  installed = false;
}

bool StopRequest::requested() noexcept { return stop_reason.load(std::memory_order_relaxed) != 0; }

int StopRequest::signal_number() noexcept {
  const int reason = stop_reason.load(std::memory_order_relaxed);
  return reason == asked_within_program ? 0 : reason;
}

void StopRequest::stop() noexcept {
  int none = 0;
  stop_reason.compare_exchange_strong(none, asked_within_program, std::memory_order_relaxed);
}

}  // namespace pneuservo
