// Dates and times of day as loggers write them.
#pragma once
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace pneuservo {

/// A date in three numbers, none of which shows which is the year, the month and the day.
struct DateParts {
  int first = 0, second = 0, third = 0;
  char sign = 0;
  bool operator==(const DateParts&) const = default;
};

enum class DateOrder { month_day_year, day_month_year, year_month_day };

/// Seconds since 1970 of a date, with a time or without, or since midnight of a time alone; none where it is neither.
/// Times of 12 hours, of a zone (a name of one counts as none), "N days hh:mm:ss", minutes with seconds ("5:02.345"),
/// durations ("1h2m3s", PT1.5S) and IEC 61131-3 (T#1s20ms, DT#2026-01-03-10:11:12) are read too.
/// parts: of a date in three numbers, which are taken in their usual order.
std::optional<double> clock_in(std::string_view field, DateParts* parts = nullptr);

/// Of a date and time in digits alone: 20260103101112.5, 20260103101112500.
std::optional<double> digits_clock_in(std::string_view field);

/// Dates of a column, whose order of day, month and year is one.
class ClockColumn {
 public:
  /// clock_in of the field of a row.
  std::optional<double> take(std::string_view field, std::size_t row);
  /// Brings the column's times to the order in which all dates are possible and the largest step is the smallest, of
  /// equals the usual one. The order in words where that moves a time.
  std::string_view settle(std::vector<double>& seconds) const;

 private:
  struct Date {
    std::size_t row;  ///< from which on it stands
    DateParts parts;
  };
  std::vector<Date> dates_;
};

}  // namespace pneuservo
