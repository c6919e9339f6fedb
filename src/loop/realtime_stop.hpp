// The wish to stop: SIGINT and SIGTERM become a flag that the loop reads at the end of a tick, in either time mode.
#pragma once
#include <csignal>

namespace pneuservo {

/// While an object lives, SIGINT and SIGTERM do not end the program but set the flag; at its end the previous
/// handlers come back and the flag is cleared. One object at a time (throws std::logic_error otherwise).
class StopRequest {
 public:
  StopRequest();
  ~StopRequest();
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;

  /// True from the first signal or stop() on; one relaxed load.
  static bool requested() noexcept;
  /// The first signal (SIGINT, SIGTERM), 0 if there was none.
  static int signal_number() noexcept;
  /// Asks for the stop from within the program.
  static void stop() noexcept;

 private:
  struct sigaction previous_interrupt_ {}, previous_terminate_ {};
};

}  // namespace pneuservo
