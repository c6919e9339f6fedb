// What is still done when the program crashes in motion: the safe output, and a last record beside the recording.
#pragma once
#include <atomic>
#include <cstdint>
#include <string>

#include <pneuservo/hal/backend.hpp>

namespace pneuservo {

/// While an object lives, SIGSEGV, SIGABRT, SIGBUS, SIGFPE and SIGILL first write the safe output through the backend,
/// leave one line in FILE.crash.txt beside the recording FILE.csv.gz and on standard error, and then end the program as
/// they do without us. Only what is safe in a handler of signals is called. The loop's thread gets two periods to end
/// by itself where another thread crashed, then the safe output goes out once more. One object at a time counts, the
/// first.
class LastResort {
 public:
  /// `recording`: its path, empty for none. The backend must outlive the object.
  LastResort(Backend& backend, const std::string& recording, double period_s);
  ~LastResort();
  LastResort(const LastResort&) = delete;
  LastResort& operator=(const LastResort&) = delete;

  /// HOT. The tick that the last record shall name.
  static void note_tick(std::int64_t tick) noexcept { tick_.store(tick, std::memory_order_relaxed); }

 private:
  friend struct LastRecord;
  static inline std::atomic<std::int64_t> tick_{-1};
  bool first_ = false;
};

}  // namespace pneuservo
