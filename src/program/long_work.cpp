// What verbs that take long show and obey.
#include "program/long_work.hpp"

#include <unistd.h>

#include <cstdio>
#include <utility>

#include <fmt/format.h>

#include "loop/realtime_stop.hpp"

namespace pneuservo {

ProgressLine::ProgressLine(bool is_shown) : is_terminal_(isatty(fileno(stderr)) != 0) {
  if (is_shown) thread_ = std::jthread([this](const std::stop_token& stop) { show(stop); });
}

void ProgressLine::tell(double share, const std::string& what) {
  const std::lock_guard lock(mutex_);
  share_ = share;
  what_ = what;
}

void ProgressLine::end() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
  if (is_terminal_) std::fprintf(stderr, "\r\033[K");
}

void ProgressLine::show(const std::stop_token& stop) {
  const auto start = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  auto wait = first_;
  while (!wake_.wait_for(lock, stop, wait, [] { return false; }) && !stop.stop_requested()) {
    const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::string text = fmt::format("{:.0f} %, {:.0f} s: {}", 100 * share_, elapsed_s, what_);
    if (is_terminal_) std::fprintf(stderr, "\r\033[K%s", text.c_str());
    else std::fprintf(stderr, "pneuservo: %s\n", text.c_str());
    wait = is_terminal_ ? std::chrono::milliseconds(500) : std::chrono::milliseconds(5000);
  }
}

EarlyStop::EarlyStop(std::string words)
    : words_(std::move(words)), thread_([this](const std::stop_token& end) { watch(end); }) {}

void EarlyStop::end() {
  const std::lock_guard lock(mutex_);
  thread_.request_stop();
}

void EarlyStop::watch(const std::stop_token& end) {
  std::unique_lock lock(mutex_);
  while (!end.stop_requested()) {
    if (StopRequest::requested()) {
      std::fprintf(stderr, "%s%s\n", isatty(fileno(stderr)) != 0 ? "\r\033[K" : "", words_.c_str());
      _exit(128 + StopRequest::signal_number());
    }
    wake_.wait_for(lock, end, std::chrono::milliseconds(50), [] { return false; });
  }
}

}  // namespace pneuservo
