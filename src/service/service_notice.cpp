// What a service manager is told: ready, alive, stopping.
#include "service/service_notice.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace pneuservo {

ServiceNotice::ServiceNotice() {
  if (const char* const name = std::getenv("NOTIFY_SOCKET")) socket_ = name;
  const char* const process = std::getenv("WATCHDOG_PID");
  const bool is_ours = process == nullptr || std::strtol(process, nullptr, 10) == getpid();
  if (const char* const limit = std::getenv("WATCHDOG_USEC"); limit != nullptr && is_ours)
    watchdog_ = std::chrono::microseconds(std::strtoll(limit, nullptr, 10));
}

void ServiceNotice::send(const std::string& message) const {
  sockaddr_un address{};
  if (socket_.empty() || socket_.size() >= sizeof address.sun_path) return;
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, socket_.data(), socket_.size());
  if (socket_[0] == '@') address.sun_path[0] = '\0';  // an abstract name
  const int descriptor = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return;
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
  sendto(descriptor, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
         reinterpret_cast<const sockaddr*>(&address), length);
  close(descriptor);
}

void ServiceNotice::ready(std::string_view status) { send("READY=1\nSTATUS=" + std::string(status)); }

void ServiceNotice::stopping() { send("STOPPING=1"); }

void ServiceNotice::alive(std::int64_t tick) {
  const auto now = std::chrono::steady_clock::now();
  if (watchdog_.count() <= 0 || tick == tick_ || now - told_ < watchdog_ / 4) return;
  tick_ = tick;
  told_ = now;
  send("WATCHDOG=1");
}

}  // namespace pneuservo
