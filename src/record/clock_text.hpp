// Dates and times of day as loggers write them.
#pragma once
#include <optional>
#include <string_view>

namespace pneuservo {

/// Seconds since 1970 of a date, with a time or without, or since midnight of a time alone; none where it is neither.
/// Times of 12 hours, of a zone (a name of one counts as none), "N days hh:mm:ss", minutes with seconds ("5:02.345"),
/// durations ("1h2m3s", PT1.5S) and IEC 61131-3 (T#1s20ms, DT#2026-01-03-10:11:12) are read too.
std::optional<double> clock_in(std::string_view field);

}  // namespace pneuservo
