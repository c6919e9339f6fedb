// The clock that devices are timed by, and waiting for one's input.
#include "input_wait.hpp"

#include <cmath>
#include <ctime>

#include <poll.h>

namespace pneuservo {
namespace {

constexpr std::int64_t ns_of_s = 1'000'000'000;

}  // namespace

std::int64_t monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * ns_of_s + now.tv_nsec;
}

bool keeps_period(std::int64_t span_ns, std::int64_t periods, double period_s) noexcept {
  return std::abs(static_cast<double>(span_ns) * 1e-9 / period_s - static_cast<double>(periods)) <= 0.5;
}

void wait_for_input(int file, std::int64_t timeout_ns) noexcept {
  pollfd waited{file, POLLIN, 0};
  const timespec time{timeout_ns / ns_of_s, timeout_ns % ns_of_s};
  ppoll(&waited, 1, &time, nullptr);
}

}  // namespace pneuservo
