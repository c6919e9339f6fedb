// A commander of the axis in this program.
#include "service/local_commander.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <sys/eventfd.h>
#include <unistd.h>

#include "config/input_error.hpp"

namespace pneuservo {

LocalCommander::LocalCommander(std::string name)
    : name_(std::move(name)), wake_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (!wake_) throw InputError(name_ + ": no event descriptor: " + std::strerror(errno));
}

bool LocalCommander::say(const CommanderWord& word) {
  if (!words_.push(word)) return false;
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(wake_.number(), &one, sizeof one);  // full: it wakes up anyway
  return true;
}

}  // namespace pneuservo
