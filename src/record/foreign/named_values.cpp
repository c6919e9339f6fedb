// Values that bear their names in a line of text.
#include "record/foreign/named_values.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "record/foreign/clock_text.hpp"
#include "record/foreign/column_words.hpp"
#include "record/foreign/field_text.hpp"
#include "record/foreign/object_text.hpp"
#include "record/foreign/units.hpp"

namespace pneuservo {

namespace {

constexpr std::string_view value_ends = " ,;|\t}])";
constexpr std::string_view digit_signs = "0123456789";

bool is_digit_at(std::string_view text, std::size_t at) {
  return at < text.size() && digit_signs.find(text[at]) != std::string_view::npos;
}

bool begins_a_name(char c) { return is_letter(c) || c == '_'; }

bool is_part_of_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80 ||
         std::string_view("_./-").find(c) != std::string_view::npos;
}

/// What a serial monitor sets before a line, "10:15:00.020 -> "; the line goes on behind it.
std::string_view stamp_taken_from(std::string_view& line) {
  constexpr std::string_view arrow = " -> ";
  const std::size_t at = line.find(arrow);
  if (at == std::string_view::npos || at == 0 || line.find_first_not_of("0123456789:.") != at) return {};
  const std::string_view stamp = line.substr(0, at);
  line.remove_prefix(at + arrow.size());
  return stamp;
}

/// The number of a text that is one with or without a unit, or with the "i" of an integer; empty where it is none.
NamedValue number_with_unit(std::string_view text, char decimal) {
  double value = 0;
  if (text.size() > 1 && text.ends_with('i') && number_in(text.substr(0, text.size() - 1), decimal, value))
    text.remove_suffix(1);
  if (number_in(text, decimal, value)) return {"", with_point(text, decimal), ""};
  const std::size_t unit = unit_start(text);
  const std::string_view number = trimmed(text.substr(0, unit));
  if (unit == text.size() || !number_in(number, decimal, value)) return {};
  return {"", with_point(number, decimal), std::string(text.substr(unit))};
}

/// A date or time of the day with the point for its decimals; empty where the text is none.
std::string clock_text(std::string_view text) {
  while (!text.empty() && std::string_view("]:,)> ").find(text.back()) != std::string_view::npos) text.remove_suffix(1);
  if (text.empty() || !clock_in(text)) return "";
  std::string out(text);
  std::replace(out.begin(), out.end(), ',', '.');
  return out;
}

/// The end of so many words between blanks.
std::size_t words_end(std::string_view text, std::size_t from, std::size_t words) {
  std::size_t end = from;
  for (std::size_t i = 0; i < words; ++i) {
    while (end < text.size() && text[end] == ' ') ++end;
    end = std::min(text.find(' ', end), text.size());
  }
  return end;
}

/// The first date or time of the day that is written in a text: at its start any, behind other words one with seconds.
struct FoundClock {
  std::string stamp;
  std::size_t begin = 0, end = 0;
};
FoundClock clock_within(std::string_view text) {
  constexpr std::size_t most_words = 4;
  bool is_first = true;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_start = std::isalnum(static_cast<unsigned char>(text[i])) != 0 &&
                          (i == 0 || std::string_view(" \t[(<>|:,;@").find(text[i - 1]) != std::string_view::npos);
    if (!is_start) continue;
    for (std::size_t words = most_words; words > 0; --words) {
      const std::size_t end = words_end(text, i, words);
      std::string stamp = clock_text(text.substr(i, end - i));
      const auto colons = std::count(stamp.begin(), stamp.end(), ':');
      if (!stamp.empty() && (is_first || colons > 1)) return {std::move(stamp), i, end};
    }
    is_first = false;
  }
  return {};
}

/// "181   [8]  80 4A 0F 00 00 00 00 00": number and bytes of a frame of a CAN bus, as many as the brackets say.
std::string_view without_frame_bytes(std::string_view text) {
  for (std::size_t at = text.find('['); at != std::string_view::npos; at = text.find('[', at + 1)) {
    if (!is_digit_at(text, at + 1) || text.substr(at + 2, 1) != "]") continue;
    const auto count = static_cast<std::size_t>(text[at + 1] - '0');
    const std::string_view before = trimmed(text.substr(0, at));
    if (count > 0 && words_end(text, at + 3, count) < text.size()) return before.substr(0, before.rfind(' ') + 1);
  }
  return text;
}

std::vector<LooseNumber> loose_numbers(std::string_view text) {
  constexpr std::string_view borders = " ,;|\t{}[]()<>@";
  std::vector<LooseNumber> out;
  bool is_behind = false;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(borders), text.size());
    std::string_view word = text.substr(0, end);
    while (word.ends_with(':')) word.remove_suffix(1);
    double value = 0;
    const std::size_t unit = unit_start(word);
    if (number_in(word.substr(0, unit), '.', value)) out.push_back({value, word.substr(0, unit), word.substr(unit)});
    else if (is_behind && unit_in(word)) out.back().unit = word;
    if (!word.empty()) is_behind = !out.empty() && out.back().text.data() == word.data();
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

/// Pairs wherever they stand in a line.
class LineScan {
 public:
  LineScan(std::string_view line, const PairStyle& style, const std::vector<std::string>& known)
      : line_(line), style_(style), known_(known), first_(line.size()) {}

  std::vector<NamedValue> take() {
    std::size_t sign = line_.find_first_of("=:");
    while (sign != std::string_view::npos) {
      const std::size_t end = take_pair(sign);
      sign = line_.find_first_of("=:", end);
    }
    return std::move(found_);
  }
  std::string_view front() const { return line_.substr(0, first_); }
  std::string_view rest() const { return line_.substr(behind_); }
  std::size_t nameless() const { return nameless_; }

 private:
  /// Takes the pair around a sign; the place from which the next sign is sought.
  std::size_t take_pair(std::size_t sign) {
    const std::size_t begin = name_begin(sign);
    if (begin == sign) return sign + 1;
    NamedValue one;
    std::string_view name = trimmed(line_.substr(begin, sign - begin));
    if (name.starts_with('"')) name = name.substr(1, name.size() - 2);
    std::size_t end = take_value(sign + 1, std::find(known_.begin(), known_.end(), name) != known_.end(), one);
    if (end == 0) return sign + 1;
    one.name = name;
    if (one.unit.empty()) end = take_unit(end, one.unit);
    first_ = std::min(first_, begin);
    nameless_ += found_.empty() || begin < behind_ ? 0 : loose_numbers(line_.substr(behind_, begin - behind_)).size();
    behind_ = end;
    found_.push_back(std::move(one));
    return end;
  }

  /// Where the name before a sign begins, its quotes included; the sign's place where there is none.
  std::size_t name_begin(std::size_t sign) const {
    std::size_t end = sign;
    while (end > behind_ && line_[end - 1] == ' ') --end;
    std::size_t begin = end;
    if (end > 1 && line_[end - 1] == '"') {
      begin = line_.rfind('"', end - 2);
      return begin == std::string_view::npos || begin < behind_ ? sign : begin;
    }
    while (begin > behind_ && is_part_of_name(line_[begin - 1])) --begin;
    const bool is_name = begin < end && begins_a_name(line_[begin]);
    const bool is_written = end < sign || (line_[sign] == ':' && sign + 1 < line_.size() && line_[sign + 1] == ' ');
    const std::size_t longer = is_written && begin < end ? begin_of_words(begin) : begin;
    return longer < begin ? longer : is_name ? begin : sign;
  }

  /// "Pressure A: 5.0": the words before the last one of a name up to what parts it from others.
  std::size_t begin_of_words(std::size_t begin) const {
    constexpr std::array<std::string_view, 9> levels{"info",  "debug", "warn",   "warning", "error",
                                                     "trace", "fatal", "notice", "critical"};
    constexpr std::size_t most_words = 3;
    std::size_t out = begin;
    for (std::size_t words = 0; words < most_words && out > behind_ + 1; ++words) {
      if (line_[out - 1] != ' ' || !is_part_of_name(line_[out - 2])) break;
      std::size_t word = out - 1;
      while (word > behind_ && is_part_of_name(line_[word - 1])) --word;
      const std::string small = in_small_letters(line_.substr(word, out - 1 - word));
      if (!begins_a_name(line_[word]) || std::find(levels.begin(), levels.end(), small) != levels.end()) break;
      out = word;
    }
    return out;
  }

  /// The value from a place on: the place behind it, 0 where there is none.
  std::size_t take_value(std::size_t from, bool is_known, NamedValue& one) const {
    const bool is_apart = line_[from - 1] == '=' || (from < line_.size() && line_[from] == ' ');
    while (from < line_.size() && (line_[from] == ' ' || line_[from] == '\t')) ++from;
    if (from == line_.size()) return 0;
    if (const char quote = line_[from]; quote == '"' || quote == '\'') {
      const std::size_t end = std::min(line_.find(quote, from + 1), line_.size());
      const std::string_view text = line_.substr(from + 1, end - from - 1);
      one = number_with_unit(text, style_.decimal);
      if (one.value.empty()) one.value = text;
      return std::min(end + 1, line_.size());
    }
    const std::size_t end = value_end(from);
    const std::string_view text = line_.substr(from, end - from);
    one = number_with_unit(text, style_.decimal);
    if (!one.value.empty()) return end;
    for (const std::size_t words : {std::size_t{2}, std::size_t{1}}) {
      const std::size_t stop = words_end(line_, from, words);
      one.value = is_apart && text.find_first_of(":-T") != std::string_view::npos
                      ? clock_text(line_.substr(from, stop - from))
                      : "";
      if (std::count(one.value.begin(), one.value.end(), ':') > 1) return stop;
    }
    one.value = is_known ? text : "";
    return text.empty() || !is_known ? 0 : end;
  }

  std::size_t value_end(std::size_t from) const {
    const bool is_in_brackets = line_[from] == '(';
    for (std::size_t i = from; i < line_.size(); ++i) {
      if (value_ends.find(line_[i]) == std::string_view::npos) continue;
      const bool is_decimal = line_[i] == ',' && style_.decimal == ',' && i > from && is_digit_at(line_, i - 1) &&
                              is_digit_at(line_, i + 1);
      if (is_in_brackets && line_[i] == ')') return i + 1;
      if (!is_decimal) return i;
    }
    return line_.size();
  }

  /// A unit behind a value, where a separator, a name or nothing follows; the place behind it.
  std::size_t take_unit(std::size_t from, std::string& unit) const {
    const std::size_t begin = std::min(line_.find_first_not_of(' ', from), line_.size());
    if (begin == from || begin == line_.size()) return from;
    std::size_t end = std::min(line_.find_first_of(" ,;|\t}]=:", begin), line_.size());
    while (end > begin && line_[end - 1] == ')' && line_.substr(begin, end - begin).find('(') == std::string_view::npos)
      --end;
    const std::string_view text = line_.substr(begin, end - begin);
    if (text.empty() || is_digit_at(text, 0) || text == "-" || !unit_in(text)) return from;
    const std::size_t next = std::min(line_.find_first_not_of(' ', end), line_.size());
    const std::size_t sign = std::min(line_.find_first_of("=:", end), line_.size());
    const bool is_before_name =
        next > end && sign < line_.size() &&
        std::all_of(
            line_.begin() + static_cast<std::ptrdiff_t>(next), line_.begin() + static_cast<std::ptrdiff_t>(sign),
            [&](char c) { return is_part_of_name(c) || (c == ' ' && line_[sign] == ':'); });
    const bool is_end = next == line_.size() || value_ends.substr(1).find(line_[next]) != std::string_view::npos;
    if (!is_end && !is_before_name) return from;
    unit = text;
    return end;
  }

  std::string_view line_;
  const PairStyle& style_;
  const std::vector<std::string>& known_;
  std::vector<NamedValue> found_;
  std::size_t first_, behind_ = 0, nameless_ = 0;
};

/// "axis,unit=mm position=0.5": a unit that a database's tag states for the values of its quantity.
void take_unit_of_tag(std::string_view line, std::vector<NamedValue>& values) {
  constexpr std::string_view tag = ",unit=";
  const std::size_t at = line.find(tag);
  if (at == std::string_view::npos) return;
  const std::string_view text = line.substr(at + tag.size());
  const std::string_view word = text.substr(0, std::min(text.find_first_of(" ,"), text.size()));
  const std::optional<Unit> unit = unit_in(word);
  for (NamedValue& one : values)
    if (const auto known = column_word(one.name);
        unit && one.unit.empty() && known && known->quantity == unit->quantity)
      one.unit = word;
}

/// What stands before and behind the pairs: a stamp, and numbers without a name. False where they are too many.
bool take_around(std::string_view front, std::string_view rest, std::size_t nameless, const PairStyle& style,
                 std::vector<NamedValue>& out) {
  constexpr std::size_t digits_of_epoch = 10;
  front = without_frame_bytes(front);
  const FoundClock clock = clock_within(front);
  NamedValue stamp{std::string(stamp_name), clock.stamp, ""};
  const std::vector<LooseNumber> numbers = loose_numbers(front.substr(clock.end));
  // Beside the clock of a log whole numbers are those of processes, lines and priorities.
  const bool is_log = !clock.stamp.empty() && front.substr(clock.end).find_first_of(",;\t") == std::string_view::npos;
  const auto counts = [&](const LooseNumber& one) { return !is_log || one.text.find('.') != std::string_view::npos; };
  const std::vector<LooseNumber> before = loose_numbers(front.substr(0, clock.begin));
  nameless += static_cast<std::size_t>(std::count_if(numbers.begin(), numbers.end(), counts) +
                                       std::count_if(before.begin(), before.end(), counts));
  rest = trimmed(rest);
  const bool is_count = rest.size() >= digits_of_epoch && rest.find_first_not_of(digit_signs) == std::string_view::npos;
  const FoundClock last = stamp.value.empty() && !is_count ? clock_within(rest) : FoundClock();
  nameless += is_count || !last.stamp.empty() ? 0 : loose_numbers(rest).size();
  if (nameless > 0 && style.stamp < numbers.size()) --nameless;
  if (nameless >= out.size()) return false;
  if (stamp.value.empty() && is_count) stamp.value = rest;
  if (stamp.value.empty()) stamp.value = last.stamp;
  if (stamp.value.empty() && style.stamp < numbers.size()) {
    stamp.value = numbers[style.stamp].text;
    stamp.unit = numbers[style.stamp].unit;
  }
  if (!stamp.value.empty()) out.insert(out.begin(), std::move(stamp));
  return true;
}

/// The pair that a field is; false where it is none.
bool pair_of_field(std::string_view field, const PairStyle& style, const std::vector<std::string>& known,
                   NamedValue& one) {
  const std::size_t at = field.find(style.sign);
  if (at == std::string_view::npos || at == 0 || std::isalpha(static_cast<unsigned char>(field.front())) == 0)
    return false;
  const std::string_view text = trimmed(field.substr(at + 1));
  one = number_with_unit(text, style.decimal);
  one.name = trimmed(field.substr(0, at));
  if (!one.value.empty()) return true;
  one.value = text;
  return std::find(known.begin(), known.end(), one.name) != known.end();
}

std::vector<NamedValue> split_pairs(std::string_view line, const PairStyle& style,
                                    const std::vector<std::string>& known) {
  std::vector<NamedValue> out;
  if (const std::string_view stamp = stamp_taken_from(line); !stamp.empty())
    out.push_back({std::string(stamp_name), std::string(stamp), ""});
  std::vector<std::string_view> fields;
  split_fields(line, {style.separator, '.', false}, fields);
  if (fields.size() > 1 && fields.back().empty()) fields.pop_back();
  for (const std::string_view field : fields) {
    NamedValue one;
    if (!pair_of_field(field, style, known, one)) return {};
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace

std::string with_point(std::string_view number, char decimal) {
  std::string out(number);
  if (decimal != ',' || out.find(',') == std::string::npos) return out;
  std::erase(out, '.');
  std::replace(out.begin(), out.end(), ',', '.');
  return out;
}

std::vector<LooseNumber> numbers_before_names(std::string_view line, const PairStyle& style) {
  const std::vector<std::string> none;
  std::string_view front = line.substr(0, line.find('{'));
  if (style.kind != PairStyle::Kind::object) {
    LineScan scan(line, style, none);
    if (scan.take().empty()) return {};
    front = scan.front();
  }
  front = without_frame_bytes(front);
  return loose_numbers(front.substr(clock_within(front).end));
}

std::vector<NamedValue> values_in(std::string_view line, const PairStyle& style,
                                  const std::vector<std::string>& known) {
  if (style.kind == PairStyle::Kind::split) return split_pairs(line, style, known);
  std::vector<NamedValue> out;
  std::string_view front, rest;
  std::size_t nameless = 0;
  if (style.kind == PairStyle::Kind::object) {
    const std::size_t at = line.find('{');
    std::optional<std::vector<NamedValue>> found = values_of_object(line.substr(std::min(at, line.size())));
    if (!found) return {};
    out = std::move(*found);
    front = line.substr(0, at) == "[" ? std::string_view() : line.substr(0, at);
  } else {
    LineScan scan(line, style, known);
    out = scan.take();
    front = scan.front();
    rest = scan.rest();
    nameless = scan.nameless();
    take_unit_of_tag(line, out);
  }
  if (out.empty() || !take_around(front, rest, nameless, style, out)) return {};
  return out;
}

}  // namespace pneuservo
