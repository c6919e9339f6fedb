// What the name of a column says of its quantity.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "record/units.hpp"

namespace pneuservo {

struct ColumnWord {
  std::string word;       ///< of the name, by which it is known
  std::string_view ours;  ///< a column of the recording format; empty: a quantity that has none, such as an error
  Quantity quantity;
  bool is_sure =
      true;  ///< false: a port, a chamber or a supply without a word for pressure, or a flow: its unit must show it
};

/// Of a name without its unit: "Actual Position", "Drucksensor 1", "/axis/position", "MAIN.fbAxis.lrPos"; none where
/// nothing in it is known. Side 1 is the one that pushes outwards: A, cap end. A set point, an error, a speed or a
/// temperature is never taken for the quantity that it belongs to.
std::optional<ColumnWord> column_word(std::string_view text);

/// Whether a word of column names stands in the text, which is one word or joined of such.
bool holds_known_word(std::string_view text);

}  // namespace pneuservo
