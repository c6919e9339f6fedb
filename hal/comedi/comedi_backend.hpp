// Backend `comedi`: the channels of a rig that stand on a DA/AD board of the PC.
#pragma once
#include <memory>

#include "analog/analog_backend.hpp"
#include "comedi/comedi_board.hpp"

namespace pneuservo {

/// All inputs by one call to the driver, all outputs by another.
class ComediBackend final : public AnalogBackend {
 public:
  /// The rig must have hal.comedi.
  explicit ComediBackend(const Rig& rig);

 protected:
  std::unique_ptr<AnalogBoard> open() override;

 private:
  void add_inputs(ComediBoard& board);
  void add_outputs(ComediBoard& board);
};

}  // namespace pneuservo
