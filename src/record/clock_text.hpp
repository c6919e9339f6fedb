// Dates and times of day as loggers write them.
#pragma once
#include <optional>
#include <string_view>

namespace pneuservo {

/// Seconds since 1970 of a date, with a time or without, or since midnight of a time alone; none where it is neither.
/// Times of 12 hours, of a zone (a name of one counts as none) and "N days hh:mm:ss" are read too.
std::optional<double> clock_in(std::string_view field);

}  // namespace pneuservo
