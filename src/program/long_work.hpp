// What verbs that take long show and obey: a line of progress, and a stop that is answered at once.
#pragma once
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace pneuservo {

/// What goes on: one line that is overwritten on a terminal, a line every few seconds elsewhere. A thread of its own
/// shows it, so that long steps have their seconds told too.
class ProgressLine {
 public:
  explicit ProgressLine(bool is_shown);
  ~ProgressLine() { end(); }
  void tell(double share, const std::string& what);
  void end();

 private:
  void show(const std::stop_token& stop);
  /// What is refused at once is refused in one line.
  static constexpr std::chrono::milliseconds first_{1500};

  const bool is_terminal_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  double share_ = 0;
  std::string what_ = "reading";
  std::jthread thread_;
};

/// While it lives a stop ends the program at once, whatever it is at: there is nothing to keep. Needs a StopRequest.
class EarlyStop {
 public:
  /// `words`: what is told then.
  explicit EarlyStop(std::string words);
  /// From here on the work itself answers a stop.
  void end();

 private:
  void watch(const std::stop_token& end);
  std::string words_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

}  // namespace pneuservo
