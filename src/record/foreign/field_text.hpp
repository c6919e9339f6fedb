// Fields of a line of text: split, unquoted, read as numbers.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace pneuservo {

/// Of ASCII, or a part of one beyond it.
constexpr bool is_letter(char c) noexcept {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
}

/// Whether there is nothing but digits.
constexpr bool are_digits(std::string_view text) noexcept {
  return text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// How the fields of a line are written.
struct FieldStyle {
  char separator = ',';  ///< ' ': any run of blanks
  char decimal = '.';
  bool is_paired = false;  ///< separator and decimal sign are both commas: two pieces make a number
  bool has_groups = false;  ///< numbers show the decimal sign: the other one stands for thousands
};

std::string_view trimmed(std::string_view text);
std::string in_small_letters(std::string_view text);

/// The fields of a line, blanks and quotes around them taken off. A separator inside quotes does not count.
void split_fields(std::string_view line, const FieldStyle& style, std::vector<std::string_view>& fields);

/// False if the whole field is no number. Digits may stand in groups of three.
bool number_in(std::string_view field, char decimal, double& value);

/// Of a number whose one group of three digits is known to be one: "1,250" is 1250.
bool number_with_groups(std::string_view field, char decimal, double& value);

/// A number with the letter of a power of ten right behind it, as "500.2k" and "1.5u"; not m, which may be metres.
bool prefixed_number(std::string_view field, char decimal, double& value);

/// Digits behind the decimal sign of a field that begins as a number; -1 where it begins otherwise.
int decimals_of(std::string_view field, char decimal);

/// A whole number as "0x1F4" or "16#1F4"; false where the field is none.
bool hexadecimal_in(std::string_view field, double& value);

/// Bytes of the valid UTF-8 character at the front; 0 where there is none.
std::size_t utf8_size(std::string_view text);

/// The text in UTF-8; what is not valid in it is taken for Latin-1.
std::string as_utf8(std::string_view text);

/// The text with Latin signs of full width, such as brackets, and digits below the line as those of ASCII.
std::string half_width(std::string_view text);

/// A field in a sentence: its beginning in UTF-8, with "?" for what a terminal would obey.
std::string shown(std::string_view field);

}  // namespace pneuservo
