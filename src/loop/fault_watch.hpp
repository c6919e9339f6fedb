// Tells a fault while the loop still runs, from a thread beside it.
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>

namespace pneuservo {

/// The loop notes the first fault; a thread of ordinary priority tells it within look_every, whatever the recording's
/// disk does. A stalled terminal stalls that thread alone, until the end of this object.
class FaultWatch {
 public:
  /// A person notices nothing shorter, and 100 looks a second cost nothing.
  static constexpr std::chrono::milliseconds look_every{10};
  using Tell = std::function<void(std::uint64_t first_faults, double fault_s)>;

  explicit FaultWatch(Tell tell);
  /// Waits until a fault that was noted is told.
  ~FaultWatch();
  FaultWatch(const FaultWatch&) = delete;
  FaultWatch& operator=(const FaultWatch&) = delete;

  /// HOT. Bits of the first tick with a fault, and its time; once.
  void note(std::uint64_t first_faults, double fault_s) noexcept {
    fault_s_ = fault_s;
    faults_.store(first_faults, std::memory_order_release);
  }

 private:
  void watch();

  Tell tell_;
  double fault_s_ = 0.0;
  std::atomic<std::uint64_t> faults_{0};
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace pneuservo
