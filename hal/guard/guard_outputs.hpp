// What `pneuservo guard` can do to the outputs of a rig: safe output on boards and bus, its own enable line.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "can/frame.hpp"
#include "comedi/comedi_board.hpp"
#include "gpio/gpio_lines.hpp"
#include "iio/iio_board.hpp"

namespace pneuservo {

/// Opened at the start; what acts afterwards allocates and blocks nothing.
class GuardOutputs {
 public:
  /// Opens board and line. Throws InputError where the rig has no output that a guard could close.
  explicit GuardOutputs(const Rig& rig);

  /// Opens the bus where it is not open; while nothing is watched. False: it is not there.
  bool open_bus();
  /// Takes frames that wait, so that a local bus has room. Hot.
  void drain() noexcept;
  /// The safe output on boards and devices of Industrial I/O alone. False: it refused. Hot.
  bool make_board_safe() noexcept;
  /// The safe output on every way there is: board, Industrial I/O, then PDO and SYNC, then NMT stop, which makes a node
  /// of CiA 401 give its substitute. False: a way failed. Hot.
  bool make_safe() noexcept;
  /// The guard's own enable line, where it has one. Hot.
  bool enable(bool active) noexcept;
  /// What it can do, a line each.
  const std::vector<std::string>& description() const noexcept { return description_; }

 private:
  void open_board();
  void open_iio();
  void prepare_frames();

  Rig rig_;
  std::unique_ptr<ComediBoard> board_;
  std::unique_ptr<IioBoard> iio_;
  std::unique_ptr<CanCarrier> bus_;
  std::unique_ptr<GpioLine> line_;
  std::vector<CanFrame> frames_;  // in the order in which they are sent
  std::vector<std::string> description_;
  bool line_is_on_ = false;
};

}  // namespace pneuservo
