// The other end of a served axis.
#include "service/command_client.hpp"

#include <array>

#include <poll.h>
#include <sys/socket.h>

#include "config/input_error.hpp"
#include "service/protocol.hpp"

namespace pneuservo {

nlohmann::ordered_json CommandClient::ask(nlohmann::ordered_json request) {
  request["version"] = protocol_version;
  request["id"] = ++id_;
  const std::string line = request.dump() + "\n";
  if (send(socket_.number(), line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size()))
    throw InputError("the axis ended the connection, expected an answer");
  for (;;) {
    nlohmann::ordered_json answer = next();
    if (answer.contains("id") ? answer["id"] == id_ : !answer.contains("status")) return answer;
  }
}

nlohmann::ordered_json CommandClient::next() {
  for (;;) {
    if (const auto end = in_.find('\n'); end != std::string::npos) {
      const std::string line = in_.substr(0, end);
      in_.erase(0, end + 1);
      auto answer = nlohmann::ordered_json::parse(line, nullptr, false);
      if (!answer.is_object())
        throw InputError("found an answer that is no JSON object, expected 'pneuservo serve' there");
      return answer;
    }
    pollfd polled{socket_.number(), POLLIN, 0};
    const auto limit = std::chrono::duration_cast<std::chrono::milliseconds>(patience);
    if (poll(&polled, 1, static_cast<int>(limit.count())) == 0)
      throw InputError("no answer came within 5 s, expected one: does the axis run?");
    std::array<char, 4096> bytes;
    const ssize_t count = recv(socket_.number(), bytes.data(), bytes.size(), 0);
    if (count <= 0) throw InputError("the axis ended the connection, expected an answer");
    in_.append(bytes.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace pneuservo
