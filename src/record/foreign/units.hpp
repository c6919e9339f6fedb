// Units as loggers write them, and what they are in SI.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace pneuservo {

/// raw: of a signal before it was scaled, such as counts, per cent, mA.
enum class Quantity { time, length, pressure, voltage, force, mass_flow, raw, other };

struct Unit {
  std::string_view name;
  Quantity quantity;
  double factor;          ///< SI value = factor theirs, gauge pressures above the atmosphere
  bool is_gauge = false;
  bool is_multiple = false;  ///< a number before or behind it says so many
  bool is_absolute = false;  ///< a pressure whose unit says so
};

/// How many of the second unit one of the first is; none where their quantities or zeros differ, or one is no unit.
std::optional<double> factor_between(std::string_view from, std::string_view to);

/// A positive number such as 0.01 or 1000.
bool is_power_of_ten(double number);

/// Whether the word says that a unit follows, in letters of any size: Unit, Einheit, uom.
bool is_unit_word(std::string_view word);

/// The text without blanks and one pair of brackets around it: "[bar (g)]" is "bar (g)".
std::string_view without_brackets(std::string_view text);

/// The unit that text stands for: mm, [bar], (V), bar(g), kPa gauge, 0.1 mm, mm/10, Millimeters; none where it is none.
std::optional<Unit> unit_in(std::string_view text);

/// "0.5 mm", "3.2V": where the unit begins behind a number; the text's size where it has none.
std::size_t unit_start(std::string_view field);

}  // namespace pneuservo
