// Tells a fault while the loop still runs.
#include "loop/fault_watch.hpp"

#include "record/ordinary_thread.hpp"

namespace pneuservo {

FaultWatch::FaultWatch(Tell tell) : tell_(std::move(tell)), thread_([this] { watch(); }) {}

FaultWatch::~FaultWatch() {
  ends_ = true;
  thread_.join();
}

void FaultWatch::watch() {
  become_ordinary_thread("fault watch");
  for (bool last = false; !last;) {
    last = ends_;  // before the look: what was noted before the end is told
    if (const std::uint64_t faults = faults_.load(std::memory_order_acquire); faults != 0)
      return tell_(faults, fault_s_);
    if (!last) std::this_thread::sleep_for(look_every);
  }
}

}  // namespace pneuservo
