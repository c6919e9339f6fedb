// Unusable input (config, recording, command line): one clear sentence with file, line, key, found and expected.
#pragma once
#include <stdexcept>
#include <string>

namespace pneuservo {

/// Ends the program with exit status 2.
struct InputError : std::runtime_error {
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace pneuservo
