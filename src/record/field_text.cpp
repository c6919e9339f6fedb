// Fields of a line of text.
#include "record/field_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>

namespace pneuservo {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string_view unquoted(std::string_view text) {
  text = trimmed(text);
  for (const char quote : {'"', '\''})
    if (text.size() >= 2 && text.front() == quote && text.back() == quote)
      return trimmed(text.substr(1, text.size() - 2));
  return text;
}

/// Where the field that begins the line ends: at a separator outside quotes.
std::size_t field_end(std::string_view line, char separator, bool has_quotes) {
  if (!has_quotes) return std::min(line.find(separator), line.size());
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    else if (line[i] == separator && !quoted) return i;
  }
  return line.size();
}

void split_at_blanks(std::string_view line, std::vector<std::string_view>& fields) {
  line = trimmed(line);
  while (!line.empty()) {
    std::size_t end = field_end(line, ' ', line.find('"') != std::string_view::npos);
    end = std::min(end, std::min(line.find('\t'), line.size()));
    fields.push_back(unquoted(line.substr(0, end)));
    line = trimmed(line.substr(end));
  }
}

/// Joins every second piece to the one before it; the text between them is the comma.
void join_pairs(std::vector<std::string_view>& fields) {
  if (fields.size() % 2 != 0) return;
  for (std::size_t i = 0; i < fields.size() / 2; ++i) {
    const char* from = fields[2 * i].data();
    const char* to = fields[2 * i + 1].data() + fields[2 * i + 1].size();
    fields[i] = {from, static_cast<std::size_t>(to - from)};
  }
  fields.resize(fields.size() / 2);
}

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

/// Days since 1970 of "year-month-day" or "day.month.year"; text moves on behind it.
std::optional<double> take_date(std::string_view& text) {
  int a = 0, b = 0, c = 0;
  std::string_view rest = text;
  if (!take_number(rest, a)) return std::nullopt;
  const bool is_dotted = !rest.empty() && rest.front() == '.';
  if (!take(rest, "-/.") || !take_number(rest, b) || !take(rest, "-/.") || !take_number(rest, c)) return std::nullopt;
  if (is_dotted) std::swap(a, c);
  const std::chrono::year_month_day date{std::chrono::year{a}, std::chrono::month{static_cast<unsigned>(b)},
                                         std::chrono::day{static_cast<unsigned>(c)}};
  if (a < 1900 || !date.ok()) return std::nullopt;
  text = rest;
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

/// Seconds of "hh:mm:ss" with decimals; text moves on behind it.
std::optional<double> take_time(std::string_view& text) {
  int hours = 0, minutes = 0, whole = 0;
  if (!take_number(text, hours) || !take(text, ":") || !take_number(text, minutes)) return std::nullopt;
  double seconds = 0;
  if (take(text, ":")) {
    if (!take_number(text, whole)) return std::nullopt;
    seconds = whole;
    if (take(text, ".,"))
      for (double place = 0.1; !text.empty() && text.front() >= '0' && text.front() <= '9'; place /= 10) {
        seconds += place * (text.front() - '0');
        text.remove_prefix(1);
      }
  }
  if (hours > 24 || minutes > 59 || seconds >= 61) return std::nullopt;
  return 3600.0 * hours + 60.0 * minutes + seconds;
}

/// Seconds that the zone at the end is ahead of universal time; none where something else stands there.
std::optional<double> zone_of(std::string_view text) {
  if (text.empty() || text == "Z") return 0.0;
  const double sign = text.front() == '-' ? -1.0 : 1.0;
  int hours = 0, minutes = 0;
  if (!take(text, "+-") || !take_number(text, hours)) return std::nullopt;
  if (hours >= 100) minutes = hours % 100, hours /= 100;  // +0100
  if (take(text, ":") && !take_number(text, minutes)) return std::nullopt;
  return text.empty() ? std::optional(sign * (3600.0 * hours + 60.0 * minutes)) : std::nullopt;
}

/// Bytes of the valid UTF-8 character at the front; 0 where there is none.
std::size_t character_size(std::string_view text) {
  const auto first = static_cast<unsigned char>(text.front());
  const std::size_t size = first < 0x80                    ? 1
                           : first >= 0xc2 && first < 0xe0 ? 2
                           : first >= 0xe0 && first < 0xf0 ? 3
                           : first >= 0xf0 && first < 0xf5 ? 4
                                                           : 0;
  if (size == 0 || text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) return 0;
  return size;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

void split_fields(std::string_view line, const FieldStyle& style, std::vector<std::string_view>& fields) {
  fields.clear();
  if (style.separator == ' ') return split_at_blanks(line, fields);
  const bool has_quotes = line.find('"') != std::string_view::npos;
  for (;;) {
    const std::size_t end = field_end(line, style.separator, has_quotes);
    fields.push_back(unquoted(line.substr(0, end)));
    if (end == line.size()) break;
    line.remove_prefix(end + 1);
  }
  if (style.is_paired) join_pairs(fields);
}

bool number_in(std::string_view field, char decimal, double& value) {
  if (field.starts_with('+')) field.remove_prefix(1);
  std::array<char, 64> copy;
  if (decimal != '.' && field.size() <= copy.size()) {
    const auto end = std::replace_copy(field.begin(), field.end(), copy.begin(), decimal, '.');
    if (std::find(field.begin(), field.end(), '.') != field.end()) return false;
    field = {copy.data(), static_cast<std::size_t>(end - copy.begin())};
  }
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error == std::errc() && end == field.data() + field.size();
}

std::optional<double> clock_in(std::string_view field) {
  if (field.find(':') == std::string_view::npos) return std::nullopt;
  const std::optional<double> days = take_date(field);
  if (days && !take(field, "T ")) return std::nullopt;
  const std::optional<double> seconds = take_time(field);
  const std::optional<double> zone_s = zone_of(trimmed(field));
  if (!seconds || !zone_s) return std::nullopt;
  return 86400.0 * days.value_or(0.0) + *seconds - *zone_s;
}

std::string as_utf8(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t size = character_size(text);
    if (size == 0) {
      const auto latin = static_cast<unsigned char>(text.front());
      out += static_cast<char>(0xc0 | (latin >> 6));
      out += static_cast<char>(0x80 | (latin & 0x3f));
    } else {
      out.append(text.substr(0, size));
    }
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return out;
}

}  // namespace pneuservo
