// The clock that devices are timed by, and waiting for one's input.
#pragma once
#include <cstdint>

namespace pneuservo {

/// Time of CLOCK_MONOTONIC [ns]. Hot.
std::int64_t monotonic_ns() noexcept;
/// So many periods of a foreign clock are timed at the start.
constexpr std::int64_t timed_periods = 10;
/// So many periods of a foreign clock span as many of ours to within half of one: ten of them to within 5 %.
bool keeps_period(std::int64_t span_ns, std::int64_t periods, double period_s) noexcept;
/// Waits for input of an open file at most so long. Hot but for the wait itself.
void wait_for_input(int file, std::int64_t timeout_ns) noexcept;

}  // namespace pneuservo
