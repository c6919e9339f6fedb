// One user at a time: locks on devices that die with the process that holds them.
#pragma once
#include <string>

namespace pneuservo {

/// Locks an open tty or board against other processes (flock). Throws std::runtime_error: "NAME: held by process 12
/// (pneuservo): ...".
void lock_device(int file, const std::string& name);

/// The process at the other end of a connected local socket: "process 12 (pneuservo)".
std::string peer_text(int connected);

/// A name that one process of the network namespace holds, as CAN interfaces belong to one.
class NameLock {
 public:
  /// `what` stands in front of who holds it. Throws std::runtime_error.
  NameLock(const std::string& name, const std::string& what);
  ~NameLock();
  NameLock(const NameLock&) = delete;
  NameLock& operator=(const NameLock&) = delete;

 private:
  int socket_ = -1;
};

}  // namespace pneuservo
