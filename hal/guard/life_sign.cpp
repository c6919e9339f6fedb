// Signs of life between the loop and `pneuservo guard`.
#include "guard/life_sign.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "device_lock.hpp"

namespace pneuservo {

std::string guard_name(const Rig& rig) {
  const std::string& stated = rig.hal->guard->name;
  std::string name = stated.empty() ? rig.name : stated;
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

LifeSignPage::LifeSignPage(const Rig& rig, Side side) : name_(guard_name(rig)), side_(side) {
  try {
    if (side == Side::guard) open_as_guard();
    else open_as_loop(rig);
    map();
  } catch (...) {
    if (file_ >= 0) close(file_);
    throw;
  }
}

// The page of a guard that was killed is taken over as it is: a loop may still write into it.
void LifeSignPage::open_as_guard() {
  const std::string path = "/pneuservo-guard-" + name_;
  file_ = shm_open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file_ < 0)
    throw std::runtime_error(fmt::format("hal.guard: shared memory {} cannot be made: {}", path, std::strerror(errno)));
  lock_device(file_, "hal.guard.name '" + name_ + "'");
  if (ftruncate(file_, sizeof(LifeSign)) != 0)
    throw std::runtime_error(fmt::format("hal.guard: shared memory {}: {}", path, std::strerror(errno)));
}

void LifeSignPage::open_as_loop(const Rig& rig) {
  const std::string path = "/pneuservo-guard-" + name_;
  const auto refuse = [&](const std::string& what) {
    throw std::runtime_error(
        fmt::format("hal.guard: {}: start 'pneuservo guard' with the config of {} first", what, rig.name));
  };
  file_ = shm_open(path.c_str(), O_RDWR | O_CLOEXEC, 0600);
  if (file_ < 0 && errno == ENOENT) refuse("no guard '" + name_ + "' is running");
  if (file_ < 0) refuse(fmt::format("the guard '{}' cannot be reached ({})", name_, std::strerror(errno)));
  struct stat status{};
  const bool is_free = flock(file_, LOCK_SH | LOCK_NB) == 0;
  if (is_free || fstat(file_, &status) != 0 || status.st_size < static_cast<off_t>(sizeof(LifeSign)))
    refuse("the guard '" + name_ + "' is not running any more");
}

void LifeSignPage::map() {
  void* const page = mmap(nullptr, sizeof(LifeSign), PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
  if (page == MAP_FAILED)
    throw std::runtime_error(
        fmt::format("hal.guard: the page of '{}' cannot be mapped: {}", name_, std::strerror(errno)));
  sign_ = static_cast<LifeSign*>(page);
  if (side_ == Side::guard && sign_->layout != LifeSign::known_layout) {
    new (page) LifeSign;
    sign_->layout = LifeSign::known_layout;
  }
  if (sign_->layout == LifeSign::known_layout) return;
  munmap(page, sizeof(LifeSign));
  throw std::runtime_error(fmt::format("hal.guard: the guard '{}' is of another version of pneuservo", name_));
}

LifeSignPage::~LifeSignPage() {
  munmap(sign_, sizeof(LifeSign));
  if (side_ == Side::guard) shm_unlink(("/pneuservo-guard-" + name_).c_str());
  close(file_);
}

}  // namespace pneuservo
