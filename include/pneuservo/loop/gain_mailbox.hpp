// One slot through which gains reach the running loop: neither side ever waits for the other.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>

#include <pneuservo/control/ppd2.hpp>

namespace pneuservo {

/// Three buffers: one is written, one is read, one lies between them with what was posted last. One thread posts, one
/// takes; both are wait-free. What is posted before the last was taken replaces it.
class GainMailbox {
 public:
  /// From outside the loop, values of a valid config.
  void post(const Ppd2GainSet& gains) noexcept {
    slots_[written_] = gains;
    written_ = between_.exchange(static_cast<std::uint8_t>(written_ | fresh), std::memory_order_acq_rel) & index;
  }
  /// HOT. True: `gains` has what was posted last.
  bool take(Ppd2GainSet& gains) noexcept {
    if ((between_.load(std::memory_order_relaxed) & fresh) == 0) return false;
    read_ = between_.exchange(read_, std::memory_order_acq_rel) & index;
    gains = slots_[read_];
    return true;
  }

 private:
  static constexpr std::uint8_t fresh = 4, index = 3;
  std::array<Ppd2GainSet, 3> slots_{};
  std::uint8_t written_ = 0, read_ = 1;
  std::atomic<std::uint8_t> between_{2};
};

}  // namespace pneuservo
