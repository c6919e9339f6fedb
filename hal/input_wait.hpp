// The clock that devices are timed by, and waiting for one's input.
#pragma once
#include <cstdint>

namespace pneuservo {

/// Time of CLOCK_MONOTONIC [ns]. Hot.
std::int64_t monotonic_ns() noexcept;
/// Waits for input of an open file at most so long. Hot but for the wait itself.
void wait_for_input(int file, std::int64_t timeout_ns) noexcept;

}  // namespace pneuservo
