// What the lines of a foreign table hold, cut in a given style.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "record/foreign/field_text.hpp"

namespace pneuservo {

/// What a line holds in a style.
struct LineFacts {
  std::size_t fields = 0, numbers = 0, empty = 0, filled = 0;  ///< filled: without empty ones at the end
  std::vector<char> is_text;  ///< of each field
  bool has_decimals = false;  ///< a number shows the decimal sign
  bool has_label() const { return !is_text.empty() && is_text.front() != 0; }
  /// More than half numbers or gaps, or two numbers of which one is the first.
  bool is_row() const { return numbers > 0 && (2 * (numbers + empty) > fields || (numbers > 1 && !has_label())); }
};

/// Whether the field is a number, with a unit behind it or not, or a time.
bool is_value(std::string_view field, const FieldStyle& style);

std::vector<LineFacts> all_facts(const std::vector<std::string>& lines, const FieldStyle& style);

/// The number of fields that most rows have; 0 where there is no row.
std::size_t usual_fields(const std::vector<LineFacts>& facts);

/// The first row: of the usual number of fields, and labelled as most rows are, for lines of a logger's head such as
/// "Samples,3000,3000" look like rows else. The lines' number where there is none.
std::size_t first_row(const std::vector<LineFacts>& facts, std::size_t fields);

/// Of the rows, fields that are numbers less what is neither number nor empty: cutting at the wrong place makes both.
/// Ties are decided by a line above with as many fields, or one right above with more, which names them, then by fewer
/// columns of text.
double score(const std::vector<LineFacts>& facts, char separator);

/// Whether rows hold values alone: dates of several words between tabs would be cut into more numbers by blanks.
bool are_values_alone(const std::vector<LineFacts>& facts);

}  // namespace pneuservo
