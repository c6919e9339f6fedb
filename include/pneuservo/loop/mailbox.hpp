// Wait-free ways between the running loop and one thread beside it: the last value, and a short queue.
#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace pneuservo {

/// Three buffers: one is written, one is read, one lies between them with what was posted last. One thread posts, one
/// takes; both are wait-free. What is posted before the last was taken replaces it.
template <class T> class Mailbox {
 public:
  void post(const T& value) noexcept {
    draft() = value;
    post_draft();
  }
  /// The buffer of the thread that posts, to write in place; post_draft() posts it and leaves another one.
  T& draft() noexcept { return slots_[written_]; }
  void post_draft() noexcept {
    written_ = between_.exchange(static_cast<std::uint8_t>(written_ | fresh), std::memory_order_acq_rel) & index;
  }
  /// True: `value` has what was posted last.
  bool take(T& value) noexcept {
    if (!has_new()) return false;
    value = *take();
    return true;
  }
  /// What was posted last, in place until the next take; null: nothing since the last one, which goes on to stand.
  const T* take() noexcept {
    if (!has_new()) return nullptr;
    read_ = between_.exchange(read_, std::memory_order_acq_rel) & index;
    return &slots_[read_];
  }
  /// Something was posted and not taken.
  bool has_new() const noexcept { return (between_.load(std::memory_order_relaxed) & fresh) != 0; }

 private:
  static constexpr std::uint8_t fresh = 4, index = 3;
  std::array<T, 3> slots_{};
  std::uint8_t written_ = 0, read_ = 1;
  std::atomic<std::uint8_t> between_{2};
};

/// In the order of the pushes, at most N at a time. One thread pushes, one pops; both are wait-free.
template <class T, std::size_t N> class WaitFreeQueue {
 public:
  static_assert((N & (N - 1)) == 0, "a counter that wraps keeps its place");
  /// False: full, nothing happened.
  bool push(const T& value) noexcept {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == N) return false;
    slots_[end % N] = value;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }
  bool pop(T& value) noexcept {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    value = slots_[begin % N];
    begin_.store(begin + 1, std::memory_order_release);
    return true;
  }

 private:
  std::array<T, N> slots_{};
  alignas(64) std::atomic<std::size_t> begin_{0};
  alignas(64) std::atomic<std::size_t> end_{0};
};

}  // namespace pneuservo
