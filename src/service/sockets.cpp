// Sockets of the service.
#include "service/sockets.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "config/input_error.hpp"

namespace pneuservo {

namespace fs = std::filesystem;

namespace {

constexpr int most_waiting = 8;
constexpr mode_t others = 0117;  // taken from 0777: reading and writing for owner and group

sockaddr_un address_of(const fs::path& path) {
  sockaddr_un address{};
  const std::string text = path.string();
  if (text.empty() || text.size() >= sizeof address.sun_path)
    throw InputError(fmt::format("{}: found a name of {} bytes, expected 1 to {} for a socket", text, text.size(),
                                 sizeof address.sun_path - 1));
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, text.data(), text.size());
  return address;
}

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

template <class Address> int connect_with(int descriptor, const Address& address) {
  return connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address);
}
template <class Address> int bind_with(int descriptor, const Address& address) {
  return bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address);
}

[[noreturn]] void refuse(const std::string& where, const std::string& expected) {
  throw InputError(fmt::format("{}: found no way ({}), expected {}", where, std::strerror(errno), expected));
}

Descriptor made(int family, const std::string& where, int flags = 0) {
  Descriptor descriptor(socket(family, SOCK_STREAM | SOCK_CLOEXEC | flags, 0));
  if (!descriptor) refuse(where, "a socket");
  return descriptor;
}

/// Takes away the name of a socket that nobody listens at.
void clear(const fs::path& path, const sockaddr_un& address) {
  struct stat there{};
  if (lstat(path.c_str(), &there) != 0) return;
  if (!S_ISSOCK(there.st_mode))
    throw InputError(fmt::format("{}: found a file that is no socket, expected a free name", path.string()));
  const Descriptor trial = made(AF_UNIX, path.string());
  if (connect_with(trial.number(), address) == 0)
    throw InputError(fmt::format("{}: found another program that serves an axis there, expected one", path.string()));
  fs::remove(path);
}

}  // namespace

Descriptor listen_at(const fs::path& path) {
  const sockaddr_un address = address_of(path);
  clear(path, address);
  Descriptor descriptor = made(AF_UNIX, path.string(), SOCK_NONBLOCK);
  const mode_t before = umask(others);
  const bool is_bound = bind_with(descriptor.number(), address) == 0;
  umask(before);
  if (!is_bound || listen(descriptor.number(), most_waiting) != 0)
    refuse(path.string(), "a folder in which this account may make a socket, or --socket PATH");
  return descriptor;
}

Descriptor listen_on_loopback(std::uint16_t port) {
  const std::string where = fmt::format("serve.tcp_port {}", port);
  Descriptor descriptor = made(AF_INET, where, SOCK_NONBLOCK);
  const int yes = 1;
  setsockopt(descriptor.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (bind_with(descriptor.number(), loopback(port)) != 0 || listen(descriptor.number(), most_waiting) != 0)
    refuse(where, "a free port");
  return descriptor;
}

Descriptor connect_to(const fs::path& path) {
  Descriptor descriptor = made(AF_UNIX, path.string());
  if (connect_with(descriptor.number(), address_of(path)) != 0)
    refuse(path.string(), "the socket of a running 'pneuservo serve', and the right to use it");
  return descriptor;
}

Descriptor connect_to_loopback(std::uint16_t port) {
  const std::string where = fmt::format("127.0.0.1:{}", port);
  Descriptor descriptor = made(AF_INET, where);
  if (connect_with(descriptor.number(), loopback(port)) != 0)
    refuse(where, "serve.tcp_port of a running 'pneuservo serve'");
  const int yes = 1;
  setsockopt(descriptor.number(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  return descriptor;
}

std::string peer_name(int descriptor) {
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  if (getpeername(descriptor, reinterpret_cast<sockaddr*>(&address), &length) == 0 && address.ss_family == AF_INET)
    return fmt::format("127.0.0.1:{}", ntohs(reinterpret_cast<const sockaddr_in*>(&address)->sin_port));
  ucred peer{};
  length = sizeof peer;
  if (getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &peer, &length) != 0) return "an unknown program";
  return fmt::format("process {}", peer.pid);
}

fs::path socket_folder() {
  if (const char* const own = std::getenv("RUNTIME_DIRECTORY")) return own;
  if (const char* const user = std::getenv("XDG_RUNTIME_DIR")) return fs::path(user) / "pneuservo";
  throw InputError("--socket: found neither it nor $XDG_RUNTIME_DIR, expected --socket PATH");
}

std::vector<fs::path> seen_sockets() {
  std::vector<fs::path> folders{"/run/pneuservo"}, found;
  if (const char* const user = std::getenv("XDG_RUNTIME_DIR")) folders.push_back(fs::path(user) / "pneuservo");
  std::error_code error;
  for (const fs::path& folder : folders)
    for (auto entry = fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied, error);
         !error && entry != fs::recursive_directory_iterator(); entry.increment(error))
      if (entry->path().extension() == ".sock") found.push_back(entry->path());
  return found;
}

}  // namespace pneuservo
