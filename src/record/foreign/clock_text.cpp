// Dates and times of day as loggers write them.
#include "record/foreign/clock_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>

#include "record/foreign/field_text.hpp"

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

constexpr int two_digits = 99;

/// Month first behind "/", else day first; the year first where it has two digits between "-".
DateOrder usual_order(const DateParts& date) {
  constexpr int months = 12;
  if (date.sign == '/' && date.first <= months) return DateOrder::month_day_year;
  return date.sign == '-' && date.third <= two_digits ? DateOrder::year_month_day : DateOrder::day_month_year;
}

/// Days since 1970 of the three numbers in this order; none where they are no date so.
std::optional<double> days_in(const DateParts& date, DateOrder order) {
  const auto& [first, second, third, sign] = date;
  if (order == DateOrder::month_day_year) return days_of(third, first, second);
  if (order == DateOrder::day_month_year) return days_of(third, second, first);
  return third <= two_digits ? days_of(first, second, third) : std::nullopt;
}

/// Days since 1970 of year-month-day, year and day of the year in three digits, day.month.year, month/day/year
/// (day/month/year where the first is above 12) or day-name-year; text moves on behind it.
std::optional<double> take_date(std::string_view& text, DateParts* parts) {
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
    rest = trimmed(rest);
  }
  if (!take_number(rest, c)) return std::nullopt;
  if (sign == '.' && rest.starts_with(". ")) rest.remove_prefix(1);  // "2026. 01. 03. 10:11"
  constexpr int most_day = 31;
  if (a > most_day || !letters.empty()) {
    if (a <= most_day) std::swap(a, c);
    const std::optional<double> days = days_of(a, b, c);
    if (days) text = rest;
    return days;
  }
  const DateParts found{a, b, c, sign};
  const std::optional<double> days = days_in(found, usual_order(found));
  if (days) text = rest;
  if (days && parts != nullptr) *parts = found;
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

/// Decimals of a second behind ".", "," or, as three digits or six, ":", or, as three digits at the end, another sign;
/// text moves on behind them. A zone has two digits or four.
double take_decimals(std::string_view& text) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789", 1), text.size());
  if (text.empty() || (text.front() == ':' && digits != 4 && digits != 7)) return 0;
  const bool is_behind_other = digits == 4 && text.size() == 4 && std::string_view("+-; ").find(text.front()) < 4;
  if (!take(text, is_behind_other ? "+-; " : ".,:")) return 0;
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
  const std::size_t end = std::min(rest.find_first_not_of("AaPpMm. "), rest.size());
  std::string letters = in_small_letters(rest.substr(0, end));
  std::erase_if(letters, [](char c) { return c == '.' || c == ' '; });
  if ((letters != "am" && letters != "pm") || hours > 12) return 0;
  text = rest.substr(end);
  return (hours == 12 ? -12 : 0) + (letters == "pm" ? 12 : 0);
}

/// Seconds of "hh:mm:ss" with decimals, behind a date also of "hh.mm.ss" and "hh-mm-ss", or of hhmmss; text moves on
/// behind it.
std::optional<double> take_time(std::string_view& text, bool is_basic, bool is_behind_date) {
  int hours = 0, minutes = 0, whole = 0;
  double seconds = 0;
  if (!take_number(text, hours)) return std::nullopt;
  const std::string_view signs = is_behind_date ? ":.-h" : ":h";
  if (is_basic) {
    whole = hours % 100, minutes = hours / 100 % 100, hours /= 10000;
    seconds = whole + take_decimals(text);
  } else {
    const char sign = text.empty() ? ' ' : text.front();
    if (!take(text, signs) || !take_number(text, minutes)) return std::nullopt;
    if (take(text, sign == 'h' ? ":" : std::string_view(&sign, 1))) {
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

/// Whether the text may name a zone: "CET", "Europe/Berlin".
bool is_zone_name(std::string_view text) {
  constexpr std::size_t longest_name = 5;
  const bool is_place = text.find('/') != std::string_view::npos;
  return (is_place || text.size() <= longest_name) && std::all_of(text.begin(), text.end(), [&](char c) {
           return std::isalpha(static_cast<unsigned char>(c)) != 0 || (is_place && (c == '/' || c == '_'));
         });
}

/// Seconds that the zone at the end is ahead of universal time, 0 for one that is named; none where something else
/// stands there. A name in brackets or behind a blank may follow. Zones are whole quarters of an hour within 14 hours.
std::optional<double> zone_of(std::string_view text) {
  constexpr int most_hours = 14, quarter = 15;
  if (text.ends_with(']')) text = text.substr(0, std::min(text.find('['), text.size()));
  if (is_zone_name(text)) return 0.0;
  if (text.starts_with("UTC") || text.starts_with("GMT")) text = trimmed(text.substr(3));
  if (const std::size_t blank = text.find(' '); blank < text.size() && is_zone_name(text.substr(blank + 1)))
    text = text.substr(0, blank);
  const double sign = text.front() == '-' ? -1.0 : 1.0;
  int hours = 0, minutes = 0;
  if (!take(text, "+-") || !take_number(text, hours)) return std::nullopt;
  if (hours >= 100) minutes = hours % 100, hours /= 100;  // +0100
  if (take(text, ":") && !take_number(text, minutes)) return std::nullopt;
  if (!text.empty() || hours > most_hours || minutes % quarter != 0) return std::nullopt;
  return sign * (3600.0 * hours + 60.0 * minutes);
}

/// "20260103T101112.5", "20260103 10:11:12": days without signs between, and a time.
std::optional<double> take_basic_date(std::string_view& text) {
  int all = 0;
  std::string_view rest = text.substr(0, 8);
  if (text.size() < 15 || std::string_view("T _-").find(text[8]) > 3 || !take_number(rest, all) || !rest.empty())
    return std::nullopt;
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

/// The text with the characters that stand for year, month, day, hour, minute and second, and the half of the day, as
/// signs.
std::string with_signs(std::string_view field) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 12> signs{{{"年", "-"},
                                                                                 {"月", "-"},
                                                                                 {"日", " "},
                                                                                 {"時", ":"},
                                                                                 {"时", ":"},
                                                                                 {"分", ":"},
                                                                                 {"秒", ""},
                                                                                 {"上午", "am"},
                                                                                 {"下午", "pm"},
                                                                                 {"午前", "am"},
                                                                                 {"오전", "am"},
                                                                                 {"오후", "pm"}}};
  std::string out(field);
  std::string_view half;
  for (const auto& [from, to] : signs)
    for (std::size_t at = out.find(from); at != std::string::npos; at = out.find(from)) {
      const bool is_half = to == "am" || to == "pm";
      if (is_half) half = to;
      out.replace(at, from.size(), is_half ? "" : to);
    }
  return std::string(trimmed(out)) + (half.empty() ? "" : " ") + std::string(half);
}

/// "10.11.12,345".
bool is_dotted_time(std::string_view field) {
  const std::size_t first = field.find('.'), comma = field.find(',');
  return first >= 1 && first <= 2 && comma == first + 6 &&
         field.find_first_not_of("0123456789.,") == std::string_view::npos && field[first + 3] == '.';
}

}  // namespace

std::optional<double> digits_clock_in(std::string_view field) {
  constexpr std::size_t date = 8, all = 14;
  if (field.size() < all || !(field.starts_with("19") || field.starts_with("20"))) return std::nullopt;
  const std::size_t digits = std::min(field.find_first_not_of("0123456789"), field.size());
  if (digits < all || (digits != all && digits != all + 3 && digits != all + 6)) return std::nullopt;
  std::string text = std::string(field.substr(0, date)) + 'T' + std::string(field.substr(date, all - date));
  if (digits > all) text += '.';
  text += field.substr(all);
  return clock_in(text);
}

std::optional<double> ClockColumn::take(std::string_view field, std::size_t row) {
  DateParts parts;
  const std::optional<double> seconds = clock_in(field, &parts);
  if (seconds && parts.first > 0 && (dates_.empty() || !(dates_.back().parts == parts))) dates_.push_back({row, parts});
  return seconds;
}

std::string_view ClockColumn::settle(std::vector<double>& seconds) const {
  if (dates_.empty()) return "";
  constexpr std::array orders{DateOrder::month_day_year, DateOrder::day_month_year, DateOrder::year_month_day};
  constexpr std::array<std::string_view, 3> words{"month, day, year", "day, month, year", "year, month, day"};
  const DateOrder usual = usual_order(dates_.front().parts);
  std::optional<DateOrder> best;
  double least_step = 0;
  for (const DateOrder order :
       {usual, DateOrder::day_month_year, DateOrder::month_day_year, DateOrder::year_month_day}) {
    double largest = 0, before = 0;
    bool is_possible = true;
    for (const Date& date : dates_) {
      const std::optional<double> days = days_in(date.parts, order);
      is_possible = is_possible && days.has_value();
      if (!is_possible) break;
      if (&date != &dates_.front()) largest = std::max(largest, std::abs(*days - before));
      before = *days;
    }
    if (is_possible && (!best || largest < least_step)) best = order, least_step = largest;
  }
  if (!best) return "";
  bool is_moved = false;
  for (std::size_t d = 0; d < dates_.size(); ++d) {
    const double shift = days_in(dates_[d].parts, *best).value_or(0) -
                         days_in(dates_[d].parts, usual_order(dates_[d].parts)).value_or(0);
    const std::size_t end = d + 1 < dates_.size() ? dates_[d + 1].row : seconds.size();
    is_moved = is_moved || shift != 0;
    for (std::size_t row = dates_[d].row; row < end; ++row) seconds[row] += day_s * shift;
  }
  const auto at = std::find(orders.begin(), orders.end(), *best) - orders.begin();
  return is_moved ? words[static_cast<std::size_t>(at)] : "";
}

std::optional<double> clock_in(std::string_view field, DateParts* parts) {
  constexpr std::size_t shortest = 4, longest = 64;  // "0:00"; a date with words
  if (field.size() > longest) return std::nullopt;
  if (std::any_of(field.begin(), field.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; })) {
    const std::string in_signs = with_signs(field);
    return in_signs == field ? std::nullopt : clock_in(in_signs, parts);
  }
  if (field.starts_with('-') && field.find(':') < shortest) {  // a time before a trigger
    const std::optional<double> seconds = clock_in(field.substr(1), parts);
    return seconds ? std::optional(-*seconds) : std::nullopt;
  }
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
    if (is_dotted_time(field)) return take_time(field, false, true);
    days = take_date(field, parts);
    if (days && field.empty()) return has_whole_year(whole) ? std::optional(day_s * *days) : std::nullopt;
    if (days) take(field, ",");
    if (days && !take(field, "T -_/")) return std::nullopt;
  } else if (basic) {
    field.remove_prefix(1);
  }
  field = trimmed(field);
  const bool is_basic = basic.has_value() && field.find(':') == std::string_view::npos;
  const std::optional<double> seconds = take_time(field, is_basic, days.has_value());
  const std::optional<double> zone_s = zone_of(trimmed(field));
  if (!seconds || !zone_s) return std::nullopt;
  return day_s * days.value_or(0.0) + *seconds - *zone_s;
}

}  // namespace pneuservo
