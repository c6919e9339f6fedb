// What the name of a column says of its quantity.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "record/foreign/units.hpp"

namespace pneuservo {

struct ColumnWord {
  std::string word;       ///< of the name, by which it is known
  std::string_view ours;  ///< a column of the recording format; empty: a quantity that has none, such as an error
  Quantity quantity;
  bool is_sure =
      true;  ///< false: a port, a chamber or a supply without a word for pressure, or a flow: its unit must show it
  bool is_actual = false;    ///< it says that it is measured
  bool is_computed = false;  ///< it, or what is before it in a path, says that it is a model's
  bool is_gauge = false;     ///< a pressure above the atmosphere
};

/// Whether values count from the atmosphere: by their unit, or by their name where the unit does not say it.
inline bool is_above_atmosphere(const Unit& unit, const std::optional<ColumnWord>& word) {
  return unit.is_gauge || (word && word->is_gauge && !unit.is_absolute);
}

/// Of a name without its unit: "Actual Position", "Drucksensor 1", "/axis/position", "MAIN.fbAxis.lrPos"; none where
/// nothing in it is known. Side 1 is the one that pushes outwards: A, cap end. A set point, an error, a speed or a
/// temperature is never taken for the quantity that it belongs to.
std::optional<ColumnWord> column_word(std::string_view text);

/// Whether the text is made of words of column names alone, one of three letters or more: "set", "filtered".
bool is_made_of_words(std::string_view text);

/// Whether a word may tell one axis from another: a number, a letter, a word that is not known, or one for a cylinder
/// or an axis with a number or letter; no quantity, side, set point, model or state.
bool may_name_axis(std::string_view word);

/// Whether it says a pressure, of any side: "Pressures", "Drücke".
bool says_pressure(std::string_view text);

/// Whether it says a cylinder and nothing else.
bool is_cylinder_word(std::string_view word);

/// 1 to 5 of a name that says a port or a pressure, this number and nothing else: "p4", "Port 2".
std::optional<int> port_number(std::string_view text);

/// Whether a word of column names stands in the text, which is one word or joined of such.
bool holds_known_word(std::string_view text);

}  // namespace pneuservo
