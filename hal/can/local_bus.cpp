// A local socket that stands in for a bus between two processes.
#include "can/local_bus.hpp"

#include <cerrno>
#include <stdexcept>

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "can/socket_frames.hpp"
#include "device_lock.hpp"
#include "input_wait.hpp"

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
  const int peer = new_socket(path);
  if (connect(peer, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int reason = errno;
    close(peer);
    errno = reason;
    fail_with_errno("unix:" + path, "nobody listens there (start 'pneuservo device RIG.yaml --can unix:" + path + "')");
  }
  add_peer(peer);
}

void LocalBus::add_peer(int socket) {
  peer_[peers_++] = {.socket = socket};
  ask_for_stamps(socket, name());
}

void LocalBus::listen_on_path() {
  const sockaddr_un address = address_of(path_);
  const int probe = new_socket(path_);
  const bool somebody = connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  const std::string who = somebody ? peer_text(probe) : "";
  close(probe);
  if (somebody) throw std::runtime_error(name() + ": somebody listens there already: " + who);
  remove_old_socket();
  listener_ = new_socket(path_);
  if (bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(listener_, static_cast<int>(most_peers)) != 0) {
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
  while (peers_ > 0) hang_up(0);
  if (listener_ < 0) return;
  close(listener_);
  struct stat found{};
  if (lstat(path_.c_str(), &found) == 0 && S_ISSOCK(found.st_mode) && found.st_ino == inode_) unlink(path_.c_str());
}

void LocalBus::hang_up(std::size_t peer) noexcept {
  close(peer_[peer].socket);
  peer_[peer] = peer_[--peers_];
  peer_[peers_].socket = -1;
}

void LocalBus::wait(std::int64_t timeout_ns) {
  std::array<pollfd, most_peers + 1> waited{};
  for (std::size_t i = 0; i < peers_; ++i) waited[i] = {peer_[i].socket, POLLIN, 0};
  const bool has_room = listener_ >= 0 && peers_ < most_peers;
  if (has_room) waited[peers_] = {listener_, POLLIN, 0};
  const timespec time{timeout_ns / 1'000'000'000, timeout_ns % 1'000'000'000};
  ppoll(waited.data(), peers_ + (has_room ? 1 : 0), &time, nullptr);
  if (!has_room || (waited[peers_].revents & POLLIN) == 0) return;
  const int peer = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (peer >= 0) add_peer(peer);
}

// A peer whose queue is full misses the frame, as a node that is too slow does; the others have it.
Sent LocalBus::send_but(std::size_t left_out, const CanFrame& frame) noexcept {
  Sent all = peers_ == 0 ? Sent::down : Sent::sent;
  for (std::size_t i = peers_; i-- > 0;) {
    if (i == left_out) continue;
    const Sent sent = send_message(peer_[i].socket, frame);
    if (sent == Sent::down) hang_up(i);
    if (sent != Sent::sent) all = peers_ == 0 ? Sent::down : Sent::queue_full;
  }
  return all;
}

Sent LocalBus::send(const CanFrame& frame) noexcept { return send_but(most_peers, frame); }

bool LocalBus::receive(ReceivedFrame& received) noexcept {
  for (std::size_t i = 0; i < peers_;) {
    const SocketMessage message = peer_[i].messages.next(peer_[i].socket);
    if (message.kind == SocketMessage::Kind::frame) {
      received = {message.frame, message.received_ns};
      if (listener_ >= 0 && peers_ > 1) send_but(i, message.frame);
      return true;
    }
    if (message.kind == SocketMessage::Kind::nothing) ++i;
    else hang_up(i);
  }
  return false;
}

std::int64_t LocalBus::now_ns() noexcept { return monotonic_ns(); }

}  // namespace pneuservo
