// The other end of a served axis: sends a request, waits for its answer.
#pragma once
#include <chrono>
#include <string>

#include <nlohmann/json.hpp>

#include "service/descriptor.hpp"

namespace pneuservo {

/// One connection. All of it throws InputError where nobody answers.
class CommandClient {
 public:
  static constexpr std::chrono::seconds patience{5};
  explicit CommandClient(Descriptor connected) : socket_(std::move(connected)) {}
  /// The answer to the request, whose version and id are put in.
  nlohmann::ordered_json ask(nlohmann::ordered_json request);
  /// The next line that comes.
  nlohmann::ordered_json next();

 private:
  Descriptor socket_;
  std::string in_;
  int id_ = 0;
};

}  // namespace pneuservo
