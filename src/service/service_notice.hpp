// What a service manager is told: ready, alive, stopping (the protocol of sd_notify: a datagram to $NOTIFY_SOCKET).
#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace pneuservo {

/// Does nothing where no manager waits for a word.
class ServiceNotice {
 public:
  ServiceNotice();
  void ready(std::string_view status);
  void stopping();
  /// The manager's watchdog is answered where the loop has done a tick since the last time.
  void alive(std::int64_t tick);
  /// How often alive() is to be called at least; 0: there is no watchdog.
  std::chrono::microseconds watchdog() const noexcept { return watchdog_; }

 private:
  void send(const std::string& message) const;

  std::string socket_;
  std::chrono::microseconds watchdog_{0};
  std::chrono::steady_clock::time_point told_;
  std::int64_t tick_ = -1;
};

}  // namespace pneuservo
