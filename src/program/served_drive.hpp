// The thread that keeps an axis on a CAN bus as a drive: frames to the drive's node and back, its words to the server.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "can/frame.hpp"
#include "drive/drive_node.hpp"
#include "service/local_commander.hpp"

namespace pneuservo {

/// Of ordinary priority: the bus is the PLC's, no device of the loop stands on it.
class ServedDrive {
 public:
  /// Opens the bus; throws std::runtime_error. The rig has serve.drive.
  explicit ServedDrive(const Rig& rig);
  ~ServedDrive();
  ServedDrive(const ServedDrive&) = delete;
  ServedDrive& operator=(const ServedDrive&) = delete;

  /// For the server.
  LocalCommander& commander() noexcept { return commander_; }
  /// "node 5 on can1".
  const std::string& name() const noexcept { return name_; }
  void start();

 private:
  void serve(const std::stop_token& ends);
  void take_frames();
  void take_from_axis();
  void send();

  std::string name_;
  DriveNode drive_;
  std::unique_ptr<CanCarrier> bus_;
  LocalCommander commander_;
  std::vector<CanFrame> out_;
  std::vector<CommanderWord> words_;  // that found no room yet
  std::jthread thread_;
};

}  // namespace pneuservo
