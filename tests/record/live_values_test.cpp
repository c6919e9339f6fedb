// Live values: what is sent over UDP is JSON of the run's columns, thinned, with faults at once; no listener is no
// harm.
#include <catch2/catch.hpp>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "config/input_error.hpp"
#include "record/live_values.hpp"

using namespace pneuservo;

namespace {

/// A listener on a free port of the loopback.
struct Listener {
  Listener() : socket(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(bind(socket, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0);
    socklen_t size = sizeof at;
    REQUIRE(getsockname(socket, reinterpret_cast<sockaddr*>(&at), &size) == 0);
    address = "127.0.0.1:" + std::to_string(ntohs(at.sin_port));
  }
  ~Listener() { close(socket); }
  std::string next() const {
    char text[4096];
    const ssize_t got = recv(socket, text, sizeof text, 0);
    return got < 0 ? "" : std::string(text, static_cast<std::size_t>(got));
  }
  int socket;
  std::string address;
};

}  // namespace

TEST_CASE("live values are thinned JSON of the columns that have a value, a new fault is sent at once") {
  const Listener listener;
  LiveValues live(listener.address, {"t_s", "x_m", "p1_port_Pa", "fault"});
  for (int i = 0; i < 25; ++i) {
    Row row;
    row.t_s = 1e-3 * i;
    row.measured[Signal::x] = 0.125;
    row.u_V = 1.0;
    row.fault = i >= 13 ? 1ull << 35 : 0;
    live.send(row);
  }
  std::vector<double> times;
  for (std::string text = listener.next(); !text.empty(); text = listener.next()) {
    const auto json = nlohmann::json::parse(text);
    REQUIRE(json.size() == 3);  // no value of a port, no column u_V
    REQUIRE(json.at("x_m") == 0.125);
    times.push_back(json.at("t_s"));
    REQUIRE(json.at("fault") == (times.back() > 0.0125 ? 1ull << 35 : 0));
  }
  REQUIRE(times.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) REQUIRE(times[i] == Approx(std::vector<double>{0.0, 0.01, 0.013, 0.023}[i]));
}

TEST_CASE("nobody listens: values are lost, nothing else, what is no address is refused") {
  std::string nobody;
  {
    const Listener listener;
    nobody = listener.address;
  }
  LiveValues live(nobody, {"t_s"});
  for (int i = 0; i < 100; ++i) {
    Row row;
    row.t_s = i;
    live.send(row);
  }
  for (const char* wrong : {"localhost", "127.0.0.1", "127.0.0.1:0", "127.0.0.1:99999", "127.0.0.1:98x", ":9870"})
    REQUIRE_THROWS_AS(LiveValues(wrong, {}), InputError);
}
