// Fields of a line of text.
#include "record/foreign/field_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <utility>

namespace pneuservo {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }

/// Blanks that do not break a line, narrow ones, and a byte order mark.
constexpr std::array<std::string_view, 5> wide_blanks{"\u00a0", "\u202f", "\u2009", "\u2007", "\ufeff"};
constexpr char latin_blank = '\xa0';

/// Bytes of a blank at the front; 0: none.
std::size_t blank_at_front(std::string_view text) {
  if (is_blank(text.front()) || text.front() == latin_blank) return 1;
  if (is_ascii(text.front())) return 0;
  for (const std::string_view blank : wide_blanks)
    if (text.starts_with(blank)) return blank.size();
  return 0;
}

std::size_t blank_at_end(std::string_view text) {
  if (is_blank(text.back())) return 1;
  if (is_ascii(text.back())) return 0;
  for (const std::string_view blank : wide_blanks)
    if (text.ends_with(blank)) return blank.size();
  const bool is_latin = text.back() == latin_blank && (text.size() == 1 || is_ascii(text[text.size() - 2]));
  return is_latin ? 1 : 0;
}

/// Between the raised quotes of word processors; the text itself where there are none.
std::string_view without_raised_quotes(std::string_view text) {
  constexpr std::size_t size = std::string_view("\u201c").size();
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> quotes{
      {{"\u201c", "\u201d"}, {"\u2018", "\u2019"}, {"\u201e", "\u201c"}}};
  for (const auto& [open, close] : quotes)
    if (text.size() >= 2 * size && text.starts_with(open) && text.ends_with(close))
      return trimmed(text.substr(size, text.size() - 2 * size));
  return text;
}

std::string_view unquoted(std::string_view text) {
  constexpr char first_of_raised = '\xe2';
  text = trimmed(text);
  if (text.starts_with(first_of_raised)) return without_raised_quotes(text);
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

/// The sign between groups of three digits at the front: a blank of any kind, an apostrophe, or of point and comma the
/// one that is not the decimal sign.
std::string_view group_sign(std::string_view text, char decimal) {
  for (const std::string_view sign : {" ", "'", "\u00a0", "\u202f", "\u2019", "\xa0"})
    if (text.starts_with(sign)) return sign;
  return text.starts_with(decimal == '.' ? ',' : '.') ? text.substr(0, 1) : std::string_view();
}

std::size_t digits_at(std::string_view text) { return std::min(text.find_first_not_of("0123456789"), text.size()); }

/// "469.900,5" or "1 234 567" with a point and without group signs; empty where digits are not in groups of three.
/// A point or comma must be told from a decimal sign by a second group or by the decimal sign itself.
std::string ungrouped(std::string_view field, char decimal, bool is_sign_sure = false) {
  std::string out;
  if (field.starts_with('-')) out = "-", field.remove_prefix(1);
  const std::size_t first = digits_at(field);
  if (first == 0 || first > 3 || field.front() == '0') return "";
  out += field.substr(0, first);
  field.remove_prefix(first);
  const std::string_view sign = group_sign(field, decimal);
  std::size_t groups = 0;
  for (; !sign.empty() && field.starts_with(sign); ++groups) {
    field.remove_prefix(sign.size());
    if (digits_at(field) != 3) return "";
    out += field.substr(0, 3);
    field.remove_prefix(3);
  }
  const bool is_sure = is_sign_sure || (sign != "." && sign != ",") || groups > 1 || field.starts_with(decimal);
  if (groups == 0 || !is_sure) return "";
  if (field.empty()) return out;
  if (field.front() != decimal || digits_at(field.substr(1)) + 1 != field.size()) return "";
  return out + "." + std::string(field.substr(1));
}

/// False if the whole text is no number with a point.
bool plain_number(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// With the signs of ASCII in place of those that word processors and Asian keyboards write, and raised digits behind
/// "^"; the blanks between a minus and its number left out.
std::string with_plain_signs(std::string_view field) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> signs{{{"\u2212", "-"},
                                                                                {"\u2010", "-"},
                                                                                {"\u2011", "-"},
                                                                                {"\u2012", "-"},
                                                                                {"\u2013", "-"},
                                                                                {"\u00d7", "*"},
                                                                                {"\u00b7", "*"},
                                                                                {"\u22c5", "*"}}};
  constexpr std::array<std::string_view, 11> raised{"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074", "\u2075",
                                                    "\u2076", "\u2077", "\u2078", "\u2079", "\u207b"};
  const std::string text = std::all_of(field.begin(), field.end(), is_ascii) ? std::string(field) : half_width(field);
  std::string out;
  bool is_raised = false;
  for (std::string_view rest = text; !rest.empty();) {
    const auto begins = [&](std::string_view sign) { return rest.starts_with(sign); };
    const auto digit = std::find_if(raised.begin(), raised.end(), begins);
    const auto sign =
        std::find_if(signs.begin(), signs.end(), [&](const auto& pair) { return rest.starts_with(pair.first); });
    if (digit != raised.end() && !std::exchange(is_raised, true)) out += '^';
    if (digit != raised.end()) out += "0123456789-"[digit - raised.begin()];
    else if (sign != signs.end()) out += sign->second;
    else out += rest.front();
    rest.remove_prefix(digit != raised.end() ? digit->size() : sign != signs.end() ? sign->first.size() : 1);
  }
  if (out.size() > 2 && (out.starts_with("- ") || out.starts_with("+ ")))
    out = (out[0] == '-' ? "-" : "") + std::string(trimmed(std::string_view(out).substr(1)));
  return out;
}

/// Where "*10^" or the like stands between mantissa and exponent, or a sign before three digits that Fortran writes
/// for an exponent of such a size: "1.5*10^-3", "1.5 x 10**-3" and "1.500-003" as "1.5E-3"; empty elsewhere.
std::string with_plain_exponent(std::string_view field, char decimal) {
  for (const std::string_view power : {"*10^", "* 10^", "*10**", "x10^", "x 10^", "x10**"})
    if (const std::size_t at = field.find(power); at != std::string_view::npos && at > 0)
      return std::string(trimmed(field.substr(0, at))) + "E" + std::string(field.substr(at + power.size()));
  constexpr std::size_t exponent_digits = 3;
  const std::size_t sign = field.find_last_of("+-");
  if (sign == std::string_view::npos || sign == 0 || field.substr(0, sign).find(decimal) == std::string_view::npos)
    return "";
  const std::string_view mantissa = field.substr(0, sign), exponent = field.substr(sign + 1);
  const bool is_exponent = exponent.size() == exponent_digits && digits_at(exponent) == exponent_digits &&
                           (mantissa.back() == decimal || digits_at(mantissa.substr(mantissa.size() - 1)) == 1);
  return is_exponent ? std::string(mantissa) + "E" + std::string(field.substr(sign)) : "";
}

/// Numbers as accountants, Fortran and word processors write them: (0.5) and 0.5- below zero, 1.0D-03, 1.0 E-03,
/// 1.0-003, 1.0*10^-3, signs and digits of other shapes.
bool rewritten_number(std::string_view field, char decimal, double& value) {
  constexpr std::size_t longest = 64;
  if (field.size() > longest) return false;
  if (const std::string plain = with_plain_signs(field); plain != field) return number_in(plain, decimal, value);
  const bool is_in_brackets = field.size() > 2 && field.front() == '(' && field.back() == ')';
  const bool ends_in_minus = field.size() > 1 && field.back() == '-';
  if (is_in_brackets || ends_in_minus) {
    const std::string_view size =
        is_in_brackets ? field.substr(1, field.size() - 2) : field.substr(0, field.size() - 1);
    if (digits_at(size) == 0 || !number_in(size, decimal, value)) return false;
    value = -value;
    return true;
  }
  if (const std::string plain = with_plain_exponent(field, decimal); !plain.empty())
    return number_in(plain, decimal, value);
  const std::size_t letter = field.find_first_of("DdEe");
  if (letter == std::string_view::npos || letter == 0) return false;
  const std::string_view mantissa = trimmed(field.substr(0, letter)), exponent = field.substr(letter + 1);
  const bool is_plain = mantissa.size() == letter && (field[letter] == 'E' || field[letter] == 'e');
  if (is_plain || mantissa.find(decimal) == std::string_view::npos || exponent.empty()) return false;
  return number_in(std::string(mantissa) + "E" + std::string(exponent), decimal, value);
}

}  // namespace

std::size_t utf8_size(std::string_view text) {
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

std::string_view trimmed(std::string_view text) {
  for (std::size_t size; !text.empty() && (size = blank_at_front(text)) > 0;) text.remove_prefix(size);
  for (std::size_t size; !text.empty() && (size = blank_at_end(text)) > 0;) text.remove_suffix(size);
  return text;
}

std::string in_small_letters(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
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
  std::string_view text = field;
  std::array<char, 64> copy;
  if (decimal != '.' && field.size() <= copy.size()) {
    const auto end = std::replace_copy(field.begin(), field.end(), copy.begin(), decimal, '.');
    text = {copy.data(), static_cast<std::size_t>(end - copy.begin())};
  }
  const bool has_point = decimal != '.' && field.find('.') != std::string_view::npos;
  return (!has_point && plain_number(text, value)) || plain_number(ungrouped(field, decimal), value) ||
         rewritten_number(field, decimal, value);
}

bool number_with_groups(std::string_view field, char decimal, double& value) {
  return plain_number(ungrouped(field, decimal, true), value);
}

bool prefixed_number(std::string_view field, char decimal, double& value) {
  constexpr std::array<std::pair<std::string_view, double>, 7> prefixes{
      {{"k", 1e3}, {"M", 1e6}, {"G", 1e9}, {"u", 1e-6}, {"\u00b5", 1e-6}, {"\u03bc", 1e-6}, {"n", 1e-9}}};
  for (const auto& [letter, power] : prefixes) {
    if (field.size() <= letter.size() || !field.ends_with(letter)) continue;
    field.remove_suffix(letter.size());
    if (digits_at(field.substr(field.size() - 1)) != 1 || !number_in(field, decimal, value)) return false;
    value *= power;
    return true;
  }
  return false;
}

int decimals_of(std::string_view field, char decimal) {
  if (field.empty() || (digits_at(field.substr(0, 1)) == 0 && field.front() != '-' && field.front() != '+')) return -1;
  const std::size_t sign = field.rfind(decimal);
  return sign == std::string_view::npos ? 0 : static_cast<int>(digits_at(field.substr(sign + 1)));
}

bool hexadecimal_in(std::string_view field, double& value) {
  for (const std::string_view sign : {"0x", "0X", "16#"}) {
    if (!field.starts_with(sign)) continue;
    field.remove_prefix(sign.size());
    std::uint64_t counts = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), counts, 16);
    value = static_cast<double>(counts);
    return error == std::errc() && end == field.data() + field.size();
  }
  return false;
}

std::string as_utf8(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t size = utf8_size(text);
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

std::string half_width(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view lead = text.substr(i, 2);
    const auto last = static_cast<unsigned char>(i + 2 < text.size() ? text[i + 2] : 0);
    if ((lead == "\xef\xbc" && last > 0x80) || (lead == "\xef\xbd" && last >= 0x80 && last < 0x9f)) {
      out += static_cast<char>(last - (lead[1] == '\xbc' ? 0x60 : 0x20));
      i += 2;
    } else if (lead == "\xe2\x82" && last >= 0x80 && last <= 0x89) {
      out += static_cast<char>('0' + last - 0x80);
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string shown(std::string_view field) {
  constexpr std::size_t most_bytes = 40;
  const std::string text = as_utf8(field.substr(0, most_bytes));
  std::string out;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t size = utf8_size(rest);
    const auto lead = static_cast<unsigned char>(rest[0]);
    const bool is_control = lead < 0x20 || lead == 0x7f || (lead == 0xc2 && static_cast<unsigned char>(rest[1]) < 0xa0);
    out += is_control ? "?" : std::string(rest.substr(0, size));
    rest.remove_prefix(size);
  }
  return field.size() > most_bytes ? out + "..." : out;
}

}  // namespace pneuservo
