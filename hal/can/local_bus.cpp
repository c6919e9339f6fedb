// A local socket that stands in for a bus between two processes.
#include "can/local_bus.hpp"

#include <algorithm>
#include <cerrno>
#include <stdexcept>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "can/canopen.hpp"
#include "can/socket_frames.hpp"

namespace pneuservo {
namespace {

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path)
    throw std::runtime_error("unix:" + path + ": expected a path of 1 to 107 characters");
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  return address;
}

int new_socket(const std::string& path) {
  const int made = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (made < 0) fail_with_errno("unix:" + path, "no socket");
  return made;
}

}  // namespace

LocalBus::LocalBus(const std::string& path, Side side) : path_(path) {
  const sockaddr_un address = address_of(path);
  if (side == Side::listens) {
    listen_on_path();
    return;
  }
  peer_ = new_socket(path);
  if (connect(peer_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int reason = errno;
    close(peer_);
    errno = reason;
    fail_with_errno("unix:" + path, "nobody listens there (start 'pneuservo device RIG.yaml --can unix:" + path + "')");
  }
  ask_for_stamps(peer_, name());
}

void LocalBus::listen_on_path() {
  const sockaddr_un address = address_of(path_);
  const int probe = new_socket(path_);
  const bool somebody = connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(probe);
  if (somebody) throw std::runtime_error(name() + ": somebody listens there already");
  remove_old_socket();
  listener_ = new_socket(path_);
  if (bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || listen(listener_, 1) != 0) {
    const int reason = errno;
    close(listener_);
    errno = reason;
    fail_with_errno(name(), "cannot be listened on");
  }
  struct stat made{};
  if (lstat(path_.c_str(), &made) == 0) inode_ = made.st_ino;
}

// Left behind by a process that was killed. Whatever else stands there is not ours.
void LocalBus::remove_old_socket() const {
  struct stat found{};
  if (lstat(path_.c_str(), &found) != 0) return;
  if (!S_ISSOCK(found.st_mode))
    throw std::runtime_error(name() + ": found something else than a socket there, expected a path of its own");
  unlink(path_.c_str());
}

LocalBus::~LocalBus() {
  hang_up();
  if (listener_ < 0) return;
  close(listener_);
  struct stat found{};
  if (lstat(path_.c_str(), &found) == 0 && S_ISSOCK(found.st_mode) && found.st_ino == inode_) unlink(path_.c_str());
}

void LocalBus::hang_up() noexcept {
  if (peer_ >= 0) close(peer_);
  peer_ = -1;
}

void LocalBus::wait(std::int64_t timeout_ns) {
  wait_for_input(peer_ >= 0 ? peer_ : listener_, timeout_ns);
  if (peer_ >= 0 || listener_ < 0) return;
  peer_ = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (peer_ >= 0) ask_for_stamps(peer_, name());
}

Sent LocalBus::send(const CanFrame& frame) noexcept {
  if (peer_ < 0) return Sent::down;
  const Sent sent = send_message(peer_, frame);
  if (sent == Sent::down) hang_up();
  return sent;
}

bool LocalBus::accepts(const CanFrame& frame) const noexcept {
  return ids_.empty() || frame.error ||
         (is_plain(frame) && std::find(ids_.begin(), ids_.end(), frame.id) != ids_.end());
}

bool LocalBus::receive(ReceivedFrame& received) noexcept {
  while (peer_ >= 0) {
    const SocketMessage message = receive_message(peer_);
    if (message.kind == SocketMessage::Kind::nothing) return false;
    if (message.kind != SocketMessage::Kind::frame) hang_up();
    else if (accepts(message.frame)) {
      received = {message.frame, message.received_ns};
      return true;
    }
  }
  return false;
}

std::int64_t LocalBus::now_ns() noexcept { return monotonic_ns(); }

}  // namespace pneuservo
