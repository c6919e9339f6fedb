// Word for a channel's origin, as recordings and reports print it.
#pragma once
#include <string_view>

#include <pneuservo/hal/channel.hpp>

namespace pneuservo {

/// "absent", "real", "simulated" or "replayed".
std::string_view origin_name(Origin origin);

}  // namespace pneuservo
