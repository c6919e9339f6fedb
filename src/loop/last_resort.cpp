// What is still done when the program crashes in motion.
#include "loop/last_resort.hpp"

#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <ctime>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "loop/realtime_stop.hpp"

namespace pneuservo {
namespace {

struct CrashSignal {
  int number;
  const char* name;
};
constexpr std::array<CrashSignal, 5> crash_signals{
    {{SIGSEGV, "SIGSEGV"}, {SIGABRT, "SIGABRT"}, {SIGBUS, "SIGBUS"}, {SIGFPE, "SIGFPE"}, {SIGILL, "SIGILL"}}};

// Everything that the handler needs, taken before.
std::atomic<Backend*> guarded{nullptr};
std::array<char, 4096> record_path{};
std::int64_t guarded_period_ns = 0;
std::array<struct sigaction, crash_signals.size()> crash_actions_before{};
/// The loop's thread may have crashed because its own stack is full.
alignas(16) std::array<char, 64 * 1024> handler_stack{};

}  // namespace

/// One line of text, put together without memory and without stdio.
struct LastRecord {
  std::array<char, 512> text{};
  std::size_t length = 0;

  void add(const char* word) noexcept {
    for (; *word != '\0' && length < text.size(); ++word) text[length++] = *word;
  }
  void add(std::int64_t number, int digits = 1) noexcept {
    std::array<char, 24> reversed{};
    std::size_t count = 0;
    const bool negative = number < 0;
    auto rest = negative ? 0 - static_cast<std::uint64_t>(number) : static_cast<std::uint64_t>(number);
    for (; rest > 0 || digits > 0; rest /= 10, --digits) reversed[count++] = static_cast<char>('0' + rest % 10);
    if (negative) add("-");
    while (count > 0 && length < text.size()) text[length++] = reversed[--count];
  }

  LastRecord(int number, bool sent) noexcept {
    add("pneuservo: crashed by ");
    for (const CrashSignal& one : crash_signals)
      if (one.number == number) add(one.name);
    if (const std::int64_t tick = LastResort::tick_.load(std::memory_order_relaxed); tick < 0) {
      add(" before the first tick");
    } else {
      const std::int64_t t_us = tick * (guarded_period_ns / 1000);
      add(" in tick ");
      add(tick);
      add(", t = ");
      add(t_us / 1'000'000);
      add(".");
      add(t_us % 1'000'000, 6);
      add(" s");
    }
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    add(", unix time ");
    add(now.tv_sec);
    add(sent ? " s: the safe output was sent to every device\n"
             : " s: the safe output could not be sent to every device\n");
  }

  void write_to(int file) const noexcept {
    // Nothing can be done about a refusal here.
    if (file >= 0 && ::write(file, text.data(), length) < 0) return;
  }
};

namespace {

void sleep_two_periods() noexcept {
  timespec rest{2 * guarded_period_ns / 1'000'000'000, static_cast<long>(2 * guarded_period_ns % 1'000'000'000)};
  while (nanosleep(&rest, &rest) != 0) {}
}

extern "C" void on_crash(int number) {
  Backend* const backend = guarded.exchange(nullptr);
  StopRequest::stop();
  bool sent = backend == nullptr || backend->emergency_write();
  if (backend != nullptr) {
    sleep_two_periods();
    sent = backend->emergency_write();
  }
  const LastRecord record(number, sent);
  if (record_path[0] != '\0') {
    const int file = open(record_path.data(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    record.write_to(file);
    if (file >= 0) close(file);
  }
  pollfd terminal{STDERR_FILENO, POLLOUT, 0};
  if (poll(&terminal, 1, 0) == 1) record.write_to(STDERR_FILENO);  // never waits for a reader
  raise(number);  // SA_RESETHAND: by its usual action, when this handler returns
}

std::string crash_path(const std::string& recording) {
  constexpr std::string_view ending = ".csv.gz";
  if (!recording.ends_with(ending)) return {};
  return recording.substr(0, recording.size() - ending.size()) + ".crash.txt";
}

}  // namespace

LastResort::LastResort(Backend& backend, const std::string& recording, double period_s) {
  Backend* none = nullptr;
  first_ = guarded.compare_exchange_strong(none, &backend);
  if (!first_) return;
  const std::string path = crash_path(recording);
  record_path.fill('\0');
  if (path.size() < record_path.size()) path.copy(record_path.data(), path.size());
  guarded_period_ns = std::llround(period_s * 1e9);
  tick_ = -1;
  const stack_t stack{handler_stack.data(), 0, handler_stack.size()};
  sigaltstack(&stack, nullptr);
  struct sigaction action{};
  action.sa_handler = on_crash;
  action.sa_flags = static_cast<int>(SA_ONSTACK | SA_RESETHAND);
  sigfillset(&action.sa_mask);
  for (std::size_t i = 0; i < crash_signals.size(); ++i)
    sigaction(crash_signals[i].number, &action, &crash_actions_before[i]);
}

LastResort::~LastResort() {
  if (!first_) return;
  for (std::size_t i = 0; i < crash_signals.size(); ++i)
    sigaction(crash_signals[i].number, &crash_actions_before[i], nullptr);
  const stack_t none{nullptr, SS_DISABLE, 0};
  sigaltstack(&none, nullptr);
  guarded = nullptr;
}

}  // namespace pneuservo
