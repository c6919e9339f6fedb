// What the time stamps of a table say: their unit, where another run begins, how far rows are apart.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace pneuservo {

/// Seconds of one unit of the stamps, and the stamp that becomes 0.
struct TimeUnit {
  double factor = 1;
  double start = 0;   ///< in the stamps' unit; not 0 for times of a calendar
  std::string words;  ///< "milliseconds", "nanoseconds since 1970"; empty: seconds, as stated
};

/// Times since 1970 or another program's epoch by their size; else seconds, unless rows would then be over 200 periods
/// of the loop, over 100 s or below 1 us apart: the unit from ns to days that brings them nearest to it, or to 1 ms.
/// period_s: of the loop; NaN: unknown. is_clock: dates, in seconds.
TimeUnit unit_of_times(const std::vector<double>& stamps, double period_s, bool is_clock);

/// Times of day, in seconds, go on behind midnight: a day is added wherever they go back by more than half of one
/// (clock) or, as plain numbers, from within the last of 20 intervals of a day to within its first. How often.
std::size_t pass_midnights(std::vector<double>& time_s, bool is_clock);

/// Counters of 16, 24 or 32 bits, with a sign or without, of seconds to nanoseconds, go on behind their last value as
/// times of day do. Bits of that counter; 0: none begins again.
int pass_wraps(std::vector<double>& time_s);

/// Rows before which the time goes back by a second, a minute or an hour less a step, as within one.
struct Turns {
  std::vector<std::size_t> rows;  ///< none: it does not
  double turn = 0;                ///< in the unit of the stamps
  std::string words;              ///< "second"
};
/// unit_s: of the stamps.
Turns turns_of(const std::vector<double>& times, double unit_s);
/// The times go on at these rows.
void pass_turns(std::vector<double>& times, const Turns& turns);

/// Rows with which a new run begins: the time goes back, and the rows after it go on from there. The first row is one.
std::vector<std::size_t> run_starts(const std::vector<double>& time_s);

/// Rows without a stamp lie evenly between those with one, where each row then takes its usual time; before the first
/// and behind the last, fewer than a usual block of them go on so. How many got a time.
std::size_t fill_between(std::vector<double>& time_s);

/// Stamps that are rounded so far that several neighbours are equal, spread evenly again, also where the resolution
/// changes with the number of digits; false where none are.
bool spread_rounded(std::vector<double>& time_s);

/// Interval of the rows, which missing rows, jitter and single wrong stamps do not move; NaN where fewer than half of
/// the steps agree on one.
double interval_of(const std::vector<double>& time_s);

}  // namespace pneuservo
