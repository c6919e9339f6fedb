// Word for a channel's origin.
#include "origin_name.hpp"

namespace pneuservo {

std::string_view origin_name(Origin origin) {
  switch (origin) {
    case Origin::real: return "real";
    case Origin::simulated: return "simulated";
    case Origin::replayed: return "replayed";
    case Origin::absent: break;
  }
  return "absent";
}

}  // namespace pneuservo
