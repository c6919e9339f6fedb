// The planted violations, and a clean step that does what the loop's bookkeeping does.
#include "guard_step.hpp"

#include <atomic>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <semaphore>
#include <stdexcept>
#include <thread>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include <pneuservo/core/rt.hpp>
#include <pneuservo/loop/grid.hpp>
#include <pneuservo/loop/timing.hpp>

#include "loop/realtime_clock.hpp"

using namespace pneuservo;

namespace {

constexpr std::size_t fresh_bytes = std::size_t{64} * 4096;
LoopTiming timing;
TimeGrid grid(0, 1'000'000);
std::mutex mutex;
std::counting_semaphore<1> held{0};
volatile char* fresh = nullptr;
void* volatile sink = nullptr;

void clean() {
  const std::int64_t now_ns = MonotonicClock::now_ns();
  timing.lateness.add(now_ns & 0xfffff);
  timing.keep_worst({grid.slot(), now_ns & 0xfffff, 1});
  grid.advance(grid.slot_ns() + 1500000);
}

void hold_mutex_for_a_while() {
  std::thread([] {
    const std::lock_guard lock(mutex);
    held.release();
    usleep(200'000);
  }).detach();
  held.acquire();
}

void violate_by_throw() {
  try {
    throw std::runtime_error("planted");
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): the throw itself is what is planted
  }
}

void violate_by_vector() {
  std::vector<double> values(100);
  sink = values.data();
}

void violate_by_sleep() {
  const timespec pause{0, 1000};
  clock_nanosleep(CLOCK_MONOTONIC, 0, &pause, nullptr);
}

void violate_by_fresh_pages() {
  for (std::size_t offset = 0; offset < fresh_bytes; offset += 4096) fresh[offset] = 1;
}

}  // namespace

void prepare_step(std::string_view name) {
  if (name == "contended_mutex") hold_mutex_for_a_while();
  if (name == "fresh_pages")
    fresh = static_cast<char*>(mmap(nullptr, fresh_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
}

bool guarded_step(std::string_view name) {
  const RtScope scope;
  if (name == "clean") clean();
  else if (name == "new") sink = new double(1.0);
  else if (name == "malloc") sink = std::malloc(1 << 22);
  else if (name == "vector") violate_by_vector();
  else if (name == "throw") violate_by_throw();
  else if (name == "mutex" || name == "contended_mutex") {
    const std::lock_guard lock(mutex);
  } else if (name == "usleep") usleep(1);
  else if (name == "write") {
    if (write(STDERR_FILENO, "", 0) != 0) return false;
  } else if (name == "clock_nanosleep") violate_by_sleep();
  else if (name == "fresh_pages") violate_by_fresh_pages();
  else return false;
  return true;
}
