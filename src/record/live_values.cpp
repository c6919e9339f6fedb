// Live values of a run as JSON over UDP.
#include "record/live_values.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "config/input_error.hpp"

namespace pneuservo {
namespace {

sockaddr_in parse_address(const std::string& address) {
  const auto refuse = [&] {
    throw InputError("--live: found '" + address + "', expected PORT, or HOST:PORT with a number as host");
  };
  const std::size_t colon = address.rfind(':');
  const bool on_loopback = colon == std::string::npos;
  const std::string host = on_loopback ? "127.0.0.1" : address.substr(0, colon);
  unsigned port = 0;
  const char* const end = address.data() + address.size();
  const auto read = std::from_chars(address.data() + (on_loopback ? 0 : colon + 1), end, port);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool good = read.ec == std::errc{} && read.ptr == end && port >= 1 && port <= 65535 &&
                    inet_pton(AF_INET, host.c_str(), &to.sin_addr) == 1;
  if (!good) refuse();
  return to;
}

}  // namespace

LiveValues::LiveValues(const std::string& address, const std::vector<std::string>& columns,
                       std::span<const std::string_view> terms)
    : columns_(columns), terms_(terms) {
  const sockaddr_in to = parse_address(address);
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const bool connected = socket_ >= 0 && connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  if (connected) shutdown(socket_, SHUT_RD);
  if (connected) return;
  const std::string why = std::strerror(errno);
  if (socket_ >= 0) close(socket_);
  throw InputError("--live: " + address + " cannot be sent to: " + why);
}

LiveValues::~LiveValues() { close(socket_); }

void LiveValues::send(const Row& row) {
  const bool new_fault = row.fault != fault_;
  if (row.t_s < next_s_ - 1e-9 && !new_fault) return;
  next_s_ = row.t_s + send_interval_s;
  fault_ = row.fault;
  text_.assign(1, '{');
  Row::visit_all(
      terms_,
      [&](std::string_view name, const auto& value) {
        const auto number = static_cast<double>(value);
        if (!std::isfinite(number) || std::find(columns_.begin(), columns_.end(), name) == columns_.end()) return;
        fmt::format_to(std::back_inserter(text_), "{}\"{}\":{}", text_.size() > 1 ? "," : "", name, value);
      },
      row);
  text_ += "}";
  // Refused by nobody's port, or no room: the next one comes soon.
  (void)!::send(socket_, text_.data(), text_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace pneuservo
