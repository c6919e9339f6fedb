// One user at a time.
#include "device_lock.hpp"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <unistd.h>

namespace pneuservo {
namespace {

std::string process_text(int pid) {
  if (pid <= 0) return "another process";
  std::string command;
  std::getline(std::ifstream(fmt::format("/proc/{}/comm", pid)), command);
  return command.empty() ? fmt::format("process {}", pid) : fmt::format("process {} ({})", pid, command);
}

[[noreturn]] void refuse(const std::string& what, int pid) {
  throw std::runtime_error(
      fmt::format("{}: held by {}: two programs must not drive one axis, end that one first", what, process_text(pid)));
}

// A line of /proc/locks: "1: FLOCK  ADVISORY  WRITE 1234 00:2e:56789 0 EOF", device in hexadecimal.
int holder_of(int file) {
  struct stat status{};
  if (fstat(file, &status) != 0) return 0;
  const std::string wanted = fmt::format("{:02x}:{:02x}:{}", major(status.st_dev), minor(status.st_dev), status.st_ino);
  std::ifstream locks("/proc/locks");
  std::string number, kind, mode, access, place, begin, end;
  for (int pid = 0; locks >> number >> kind >> mode >> access >> pid >> place >> begin >> end;)
    if (kind == "FLOCK" && place == wanted) return pid;
  return 0;
}

// In the abstract namespace: no file is left behind, and the kernel frees the name when its process dies.
std::pair<sockaddr_un, socklen_t> abstract_address(const std::string& name) {
  std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a: a path may be longer than the 107 characters of a name
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string text = fmt::format("pneuservo/{:016x}", hash);
  text.copy(address.sun_path + 1, sizeof address.sun_path - 1);
  return {address, static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size())};
}

int process_behind(int connected) {
  ucred peer{};
  socklen_t size = sizeof peer;
  return getsockopt(connected, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 ? peer.pid : 0;
}

int peer_of(const sockaddr_un& address, socklen_t length) {
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const bool connected = connect(probe, reinterpret_cast<const sockaddr*>(&address), length) == 0;
  const int process = connected ? process_behind(probe) : 0;
  close(probe);
  return process;
}

}  // namespace

std::string peer_text(int connected) { return process_text(process_behind(connected)); }

void lock_device(int file, const std::string& name) {
  if (flock(file, LOCK_EX | LOCK_NB) == 0) return;
  if (errno == EWOULDBLOCK) refuse(name, holder_of(file));
  throw std::runtime_error(fmt::format("{}: cannot be locked: {}", name, std::strerror(errno)));
}

NameLock::NameLock(const std::string& name, const std::string& what) {
  const auto [address, length] = abstract_address(name);
  socket_ = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket_ >= 0 && bind(socket_, reinterpret_cast<const sockaddr*>(&address), length) == 0 &&
      listen(socket_, 1) == 0)
    return;
  const int reason = errno;
  if (socket_ >= 0) close(socket_);
  if (reason == EADDRINUSE) refuse(what, peer_of(address, length));
  throw std::runtime_error(fmt::format("{}: cannot be locked: {}", what, std::strerror(reason)));
}

NameLock::~NameLock() {
  if (socket_ >= 0) close(socket_);
}

}  // namespace pneuservo
