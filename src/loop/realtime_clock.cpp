// Touching memory before the loop needs it.
#include "loop/realtime_clock.hpp"

#include <alloca.h>
#include <unistd.h>

namespace pneuservo {

void prefault(void* memory, std::size_t bytes) noexcept {
  if (bytes == 0) return;
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  auto* const first = static_cast<volatile char*>(memory);
  for (std::size_t offset = 0; offset < bytes; offset += page) first[offset] = first[offset];
  first[bytes - 1] = first[bytes - 1];
}

// Not inlined: the frame that is touched must lie below the loop's frames to come, and be given back.
[[gnu::noinline]] void prefault_stack(std::size_t bytes) noexcept {
  if (bytes > 0) prefault(alloca(bytes), bytes);
}

}  // namespace pneuservo
