// From the word in a config or after --can to what carries the frames.
#include "can/open_carrier.hpp"

#include "can/local_bus.hpp"
#include "can/slcan_line.hpp"
#include "can/socketcan.hpp"

namespace pneuservo {

std::unique_ptr<CanCarrier> open_carrier(const std::string& word, double bit_rate_bps, bool listens) {
  constexpr std::string_view serial = "slcan:", local = "unix:";
  if (word.starts_with(serial)) return std::make_unique<SlcanLine>(word.substr(serial.size()), bit_rate_bps);
  if (word.starts_with(local))
    return std::make_unique<LocalBus>(word.substr(local.size()),
                                      listens ? LocalBus::Side::listens : LocalBus::Side::connects);
  return std::make_unique<SocketCan>(word);
}

}  // namespace pneuservo
