// Fields of a line of text: split, unquoted, read as numbers or as times of a clock.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pneuservo {

/// How the fields of a line are written.
struct FieldStyle {
  char separator = ',';  ///< ' ': any run of blanks
  char decimal = '.';
  bool is_paired = false;  ///< separator and decimal sign are both commas: two pieces make a number
};

std::string_view trimmed(std::string_view text);

/// The fields of a line, blanks and quotes around them taken off. A separator inside quotes does not count.
void split_fields(std::string_view line, const FieldStyle& style, std::vector<std::string_view>& fields);

/// False if the whole field is no number.
bool number_in(std::string_view field, char decimal, double& value);

/// Seconds since 1970 of a date with time (ISO 8601, also with blanks, slashes or day.month.year), or since midnight
/// of a time alone; none where it is neither.
std::optional<double> clock_in(std::string_view field);

/// The text in UTF-8; what is not valid in it is taken for Latin-1.
std::string as_utf8(std::string_view text);

}  // namespace pneuservo
