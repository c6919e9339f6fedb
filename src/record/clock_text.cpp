// Dates and times of day as loggers write them.
#include "record/clock_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <initializer_list>
#include <string>
#include <utility>

#include "record/field_text.hpp"

namespace pneuservo {

namespace {

constexpr double day_s = 86400;

/// Reads digits and moves on; false where there are none.
bool take_number(std::string_view& text, int& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || value < 0) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool take(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

std::string small_letters(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (!std::isalpha(static_cast<unsigned char>(c))) break;
    out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return out;
}

/// 1 to 12 of a month's name, English or German, whole or its first three letters; 0 where it is none.
int month_named(const std::string& letters) {
  constexpr std::array<std::string_view, 16> names{"jan", "feb", "mar", "apr", "may", "jun", "jul", "aug",
                                                   "sep", "oct", "nov", "dec", "mai", "okt", "dez", "mrz"};
  constexpr std::array<int, 16> months{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 5, 10, 12, 3};
  const auto at = std::find(names.begin(), names.end(), letters.substr(0, 3));
  return at == names.end() ? 0 : months[static_cast<std::size_t>(at - names.begin())];
}

std::optional<double> days_of(int year, int month, int day) {
  if (year < 100) year += 2000;
  const std::chrono::year_month_day date{std::chrono::year{year}, std::chrono::month{static_cast<unsigned>(month)},
                                         std::chrono::day{static_cast<unsigned>(day)}};
  if (year < 1900 || !date.ok()) return std::nullopt;
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

/// Moves on behind a day of the week, English or German, whole or short: "Mon, ", "Mo. ".
void leave_out_weekday(std::string_view& text) {
  constexpr std::array<std::string_view, 14> names{"mon", "tue", "wed", "thu", "fri", "sat", "sun",
                                                   "mo",  "di",  "mi",  "do",  "fr",  "sa",  "so"};
  const std::string letters = small_letters(text);
  const bool is_german = letters.ends_with("tag") || letters.ends_with("woch") || letters.ends_with("abend");
  const std::string start = is_german                  ? letters.substr(0, 2)
                            : letters.ends_with("day") ? letters.substr(0, 3)
                                                       : letters;
  if (std::find(names.begin(), names.end(), start) == names.end()) return;
  std::string_view rest = text.substr(letters.size());
  if (!take(rest, ".,") && !rest.starts_with(' ')) return;
  take(rest, ",");
  text = trimmed(rest);
}

/// Takes a year of four digits off the end, where nothing but a blank is before it: "10:11:12 2026"; 0: there is none.
int take_year_at_end(std::string_view& text) {
  constexpr std::size_t digits = 4;
  int year = 0;
  if (text.size() <= digits || text[text.size() - digits - 1] != ' ') return 0;
  std::string_view last = text.substr(text.size() - digits);
  if (!take_number(last, year) || !last.empty()) return 0;
  text = trimmed(text.substr(0, text.size() - digits));
  return year;
}

/// Days since 1970 of "Jan 3 2026" or "Jan 3, 2026"; the year may be at the end of the text, as C writes times, or
/// missing, as in a system's log: any leap year then. Text moves on to the time.
std::optional<double> take_named_date(std::string_view& text) {
  constexpr int any_year = 2000, first_year = 1000;
  const std::string letters = small_letters(text);
  const int month = month_named(letters);
  std::string_view rest = text.substr(letters.size());
  int day = 0, year = 0;
  while (take(rest, ".-/ ")) {}
  if (month == 0 || !take_number(rest, day)) return std::nullopt;
  take(rest, ",-/");
  rest = trimmed(rest);
  std::string_view behind = rest;
  if (take_number(behind, year) && year >= first_year) rest = trimmed(behind);
  else year = take_year_at_end(rest);
  const std::optional<double> days = days_of(year > 0 ? year : any_year, month, day);
  if (days) text = rest;
  return days;
}

/// Days since 1970 of year-month-day, year and day of the year in three digits, day.month.year, month/day/year
/// (day/month/year where the first is above 12) or day-name-year; text moves on behind it.
std::optional<double> take_date(std::string_view& text) {
  int a = 0, b = 0, c = 0;
  std::string_view rest = text;
  if (!take_number(rest, a) || rest.empty()) return std::nullopt;
  const char sign = rest.front();
  if (!take(rest, "-/. ")) return std::nullopt;
  rest = trimmed(rest);
  const std::string letters = small_letters(rest);
  if (!letters.empty()) {
    b = month_named(letters);
    rest.remove_prefix(letters.size());
    while (take(rest, "-/. ")) {}
  } else {
    const std::size_t digits = rest.size();
    if (sign == ' ' || !take_number(rest, b)) return std::nullopt;
    if (digits - rest.size() == 3 && sign == '-') {
      const std::optional<double> first = days_of(a, 1, 1), next = days_of(a + 1, 1, 1);
      if (!first || b < 1 || b > *next - *first) return std::nullopt;
      text = rest;
      return *first + b - 1;
    }
    if (!take(rest, "-/.")) return std::nullopt;
  }
  if (!take_number(rest, c)) return std::nullopt;
  constexpr int most_day = 31, months = 12;
  if (a <= most_day && sign == '/' && letters.empty() && a <= months) std::swap(a, b);
  if (a <= most_day && (sign != '-' || !letters.empty() || c > 99)) std::swap(a, c);
  const std::optional<double> days = days_of(a, b, c);
  if (days) text = rest;
  return days;
}

/// Whether four digits stand together: without them a date alone may be anything in three parts.
bool has_whole_year(std::string_view text) {
  std::size_t digits = 0;
  for (const char c : text) {
    digits = c >= '0' && c <= '9' ? digits + 1 : 0;
    if (digits == 4) return true;
  }
  return false;
}

/// Decimals of a second behind ".", "," or, as three digits or six, ":"; text moves on behind them.
double take_decimals(std::string_view& text) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789", 1), text.size());
  if (text.empty() || (text.front() == ':' && digits != 4 && digits != 7) || !take(text, ".,:")) return 0;
  double seconds = 0;
  for (double place = 0.1; !text.empty() && text.front() >= '0' && text.front() <= '9'; place /= 10) {
    seconds += place * (text.front() - '0');
    text.remove_prefix(1);
  }
  return seconds;
}

/// Hours that "AM" or "PM" behind the time add to it; text moves on behind them.
int take_half_of_day(std::string_view& text, int hours) {
  const std::string_view rest = trimmed(text);
  const std::string letters = small_letters(rest);
  if ((letters != "am" && letters != "pm") || hours > 12) return 0;
  text = rest.substr(2);
  return (hours == 12 ? -12 : 0) + (letters == "pm" ? 12 : 0);
}

/// Seconds of "hh:mm:ss" with decimals, or of hhmmss behind a T; text moves on behind it.
std::optional<double> take_time(std::string_view& text, bool is_basic) {
  int hours = 0, minutes = 0, whole = 0;
  double seconds = 0;
  if (!take_number(text, hours)) return std::nullopt;
  if (is_basic) {
    whole = hours % 100, minutes = hours / 100 % 100, hours /= 10000;
    seconds = whole + take_decimals(text);
  } else {
    if (!take(text, ":") || !take_number(text, minutes)) return std::nullopt;
    if (take(text, ":")) {
      if (!take_number(text, whole)) return std::nullopt;
      seconds = whole + take_decimals(text);
    } else if (text.starts_with('.') || text.starts_with(',')) {  // minutes and seconds alone
      return 60.0 * hours + minutes + take_decimals(text);
    }
    hours += take_half_of_day(text, hours);
  }
  if (hours > 24 || minutes > 59 || seconds >= 61) return std::nullopt;
  return 3600.0 * hours + 60.0 * minutes + seconds;
}

/// Seconds that the zone at the end is ahead of universal time, 0 for one that is named; none where something else
/// stands there. A name in brackets may follow.
std::optional<double> zone_of(std::string_view text) {
  if (text.ends_with(']')) text = text.substr(0, std::min(text.find('['), text.size()));
  constexpr std::size_t longest_name = 5;
  if (small_letters(text).size() == text.size() && text.size() <= longest_name) return 0.0;
  const double sign = text.front() == '-' ? -1.0 : 1.0;
  int hours = 0, minutes = 0;
  if (!take(text, "+-") || !take_number(text, hours)) return std::nullopt;
  if (hours >= 100) minutes = hours % 100, hours /= 100;  // +0100
  if (take(text, ":") && !take_number(text, minutes)) return std::nullopt;
  return text.empty() ? std::optional(sign * (3600.0 * hours + 60.0 * minutes)) : std::nullopt;
}

/// "20260103T101112.5": days and time without signs between.
std::optional<double> take_basic_date(std::string_view& text) {
  int all = 0;
  std::string_view rest = text.substr(0, 8);
  if (text.size() < 15 || text[8] != 'T' || !take_number(rest, all) || !rest.empty()) return std::nullopt;
  const std::optional<double> days = days_of(all / 10000, all / 100 % 100, all % 100);
  if (days) text.remove_prefix(8);
  return days;
}

/// "2 days 00:00:01": the days; text moves on to the time.
std::optional<double> take_days(std::string_view& text) {
  int days = 0;
  std::string_view rest = text;
  if (!take_number(rest, days)) return std::nullopt;
  rest = trimmed(rest);
  const std::string letters = small_letters(rest);
  if (letters != "day" && letters != "days") return std::nullopt;
  text = trimmed(rest.substr(letters.size()));
  take(text, ",");
  text = trimmed(text);
  return days;
}

/// Seconds of one part of a duration by its unit's letters; 0: none.
double seconds_of(const std::string& unit) {
  constexpr std::array<std::pair<std::string_view, double>, 8> units{
      {{"d", day_s}, {"h", 3600.0}, {"m", 60.0}, {"min", 60.0}, {"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}}};
  const auto at = std::find_if(units.begin(), units.end(), [&](const auto& one) { return one.first == unit; });
  return at == units.end() ? 0.0 : at->second;
}

/// "1h2m3.5s", "0h 1m 2s", "1s_20ms": of at least so many parts, each smaller than the one before.
std::optional<double> duration_in(std::string_view text, std::size_t least_parts) {
  double sum_s = 0, before_s = 2 * day_s;
  std::size_t parts = 0;
  for (; !text.empty(); ++parts) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
    if (error != std::errc() || value < 0) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    const std::string unit = small_letters(text);
    const double unit_s = seconds_of(unit);
    if (!(unit_s > 0) || unit_s >= before_s) return std::nullopt;
    before_s = unit_s;
    sum_s += value * unit_s;
    text.remove_prefix(unit.size());
    while (take(text, "_ ")) {}
  }
  return parts >= least_parts ? std::optional(sum_s) : std::nullopt;
}

/// Takes off what IEC 61131-3 (T#1s20ms, DT#2026-01-03-10:11:12, TOD#10:11:12) or ISO 8601 (PT1.5S) puts before a time.
/// True: a duration follows.
bool take_prefix(std::string_view& field) {
  const std::size_t sign = field.find('#');
  if (field.starts_with("PT")) {
    field.remove_prefix(2);
    return true;
  }
  if (sign == std::string_view::npos || sign > std::string_view("DATE_AND_TIME").size()) return false;
  std::string name(field.substr(0, sign));
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
  const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const bool is_duration = is_one_of({"T", "TIME", "LT", "LTIME"});
  if (is_duration || is_one_of({"DT", "LDT", "DATE_AND_TIME", "TOD", "LTOD", "TIME_OF_DAY", "D", "DATE"}))
    field.remove_prefix(sign + 1);
  return is_duration;
}

}  // namespace

std::optional<double> clock_in(std::string_view field) {
  constexpr std::size_t shortest = 4;  // "0:00"
  if (take_prefix(field)) return duration_in(field, 1);
  if (const std::optional<double> duration_s = duration_in(field, 2)) return duration_s;
  leave_out_weekday(field);
  const bool is_named = !small_letters(field).empty();
  if (field.size() < shortest || (!is_named && (field.front() < '0' || field.front() > '9'))) return std::nullopt;
  const std::string_view whole = field;
  const std::optional<double> basic = take_basic_date(field);
  std::optional<double> days = basic ? basic : is_named ? take_named_date(field) : take_days(field);
  if (is_named && (!days || field.empty())) return std::nullopt;
  if (!days) {
    days = take_date(field);
    if (days && field.empty()) return has_whole_year(whole) ? std::optional(day_s * *days) : std::nullopt;
    if (days) take(field, ",");
    if (days && !take(field, "T -_")) return std::nullopt;
  } else if (basic) {
    field.remove_prefix(1);
  }
  field = trimmed(field);
  const std::optional<double> seconds = take_time(field, basic.has_value());
  const std::optional<double> zone_s = zone_of(trimmed(field));
  if (!seconds || !zone_s) return std::nullopt;
  return day_s * days.value_or(0.0) + *seconds - *zone_s;
}

}  // namespace pneuservo
