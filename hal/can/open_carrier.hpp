// From the word in a config or after --can to what carries the frames.
#pragma once
#include <memory>
#include <string>

#include "can/frame.hpp"

namespace pneuservo {

/// "can0": interface of the kernel; "slcan:/dev/ttyACM0": serial adapter; "unix:PATH": local socket. `listens`: for a
/// local socket, this is the side that others connect to. Throws std::runtime_error with the way to mend it.
std::unique_ptr<CanCarrier> open_carrier(const std::string& word, double bit_rate_bps, bool listens);

}  // namespace pneuservo
