// The wish to stop: every signal that would end or halt the program becomes a flag that the loop reads at the end of a
// tick, in either time mode.
#pragma once
#include <string>

namespace pneuservo {

/// Which signals are wishes to stop. Work that moves nothing may be halted (SIGTSTP) and is ended by the others as
/// usual.
enum class StopSignals { interrupt_and_terminate, every };

/// While an object lives, signals set the flag instead of ending the program. With `every` none that a process can
/// catch ends or halts it but those of a crash (loop/last_resort.hpp): SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP,
/// SIGUSR1, SIGALRM and their like. A write to a pipe without reader, to a terminal that may not be written or to a
/// file that is too large becomes an error of the call; a SIGPIPE that another process sends is a wish. SIGHUP that was
/// ignored at the start stays so (nohup). At the end the previous handlers come back and the flag is cleared. Objects
/// may be nested: the outermost one counts.
class StopRequest {
 public:
  explicit StopRequest(StopSignals signals = StopSignals::interrupt_and_terminate);
  ~StopRequest();
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;

  /// True from the first signal or stop() on; one relaxed load.
  static bool requested() noexcept;
  /// The first signal, 0 if there was none.
  static int signal_number() noexcept;
  /// "SIGTERM" of the first signal; empty if there was none.
  static std::string signal_name();
  /// Signals so far.
  static int signals() noexcept;
  /// Asks for the stop from within the program. Async-signal-safe.
  static void stop() noexcept;
  /// The axis stands and its recording is closed: a signal that comes later than `patience_s` from now ends the program
  /// as it would without us, so that a stalled output cannot hold it. Signals of one burst come within the patience.
  static void let_go(double patience_s) noexcept;

  /// Two means of stopping (a terminal and a service manager) and a person's second Ctrl-C come within this time.
  static constexpr double patience_s = 1.0;
};

/// Ignores SIGPIPE for the whole program: a reader that goes away must not end it.
void ignore_broken_pipes() noexcept;

}  // namespace pneuservo
