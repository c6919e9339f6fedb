// Backend `iio`: the channels of a rig that stand on devices of the kernel's Industrial I/O.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "analog/analog_backend.hpp"
#include "iio/iio_board.hpp"

namespace pneuservo {

/// With hal.iio.trigger the loop is locked to the scans; without, each tick reads the inputs itself.
class IioBackend final : public AnalogBackend {
 public:
  /// The rig must have hal.iio.
  explicit IioBackend(const Rig& rig);

  bool is_paced() const noexcept override { return !parameters_.trigger.empty(); }
  Pace await_sample() noexcept override;

 protected:
  std::unique_ptr<AnalogBoard> open() override;

 private:
  friend std::vector<std::string> iio_refusals(const Rig& rig);
  void add_inputs(IioBoard& board);
  void add_outputs(IioBoard& board);

  IioParameters parameters_;
  IioBoard* iio_ = nullptr;  // the base has it
  std::int64_t period_ns_ = 0, timeout_ns_ = 0;
  bool is_silent_ = false;
};

/// Why this machine refuses the rig's channels on Industrial I/O, the first of inputs and of outputs; none: it has all
/// of them. Other programs may have the devices; nothing is written.
std::vector<std::string> iio_refusals(const Rig& rig);

}  // namespace pneuservo
