// Numbers with units as data sheets write them (3.5 m, 6 bar gauge, 700 l/min), read into the SI unit of a field.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include <pneuservo/core/field.hpp>

namespace pneuservo {

/// Powers of m, kg, s, K, V, A, rad.
using Dimension = std::array<int, 7>;

/// A unit against its SI unit: value_SI = value numerator/denominator 10^exponent. Apart, so that a decimal stays
/// exact.
struct UnitOfMeasure {
  Dimension dimension{};
  double numerator = 1.0, denominator = 1.0;
  int exponent = 0;
};

/// Product of symbols with prefixes and powers: "mm", "l/min", "dm3/(s bar)", "N s/m". None where it is no unit.
std::optional<UnitOfMeasure> parse_unit(std::string_view text);

/// The field's key without the ending that its unit gives it (length of length_m); empty where it has none.
std::string_view key_without_unit(const Field& field);

/// What a value counts from where it is no size or difference. A pressure that cannot be 0 counts from vacuum, a
/// temperature from absolute zero, a length that may be negative is a position from mid-stroke.
enum class Datum { none, vacuum, absolute_zero, mid_stroke };
Datum datum_of(const Field& field);

/// What values of the places of a machine are counted from.
struct Datums {
  double atmosphere_Pa = 101325.0;
  double stroke_m = 0.0;  ///< 0: not known
  /// Of free air (ISO 8778: 20 degC, 1 bar): flow meters state a mass flow by its volume (20 l/min, 20 Nl/min).
  double free_air_kgpm3 = 1e5 / (287.0 * 293.15);
};

/// The SI value of a text with its unit, or what was expected instead.
struct ReadQuantity {
  std::optional<double> value;
  std::string expected;
};
ReadQuantity read_quantity(const Field& field, std::string_view text, const Datums& datums);

/// What a value with its unit looks like, for the words after "expected".
std::string example_quantity(const Field& field);

/// Both ends of "0 to 10 V", "4 to 20 mA", "0 to 10 bar gauge" in SI; the unit stands at the last end at least.
struct ReadRange {
  std::optional<std::array<double, 2>> ends;
  std::string expected;
};
ReadRange read_range(const Field& field, std::string_view text, const Datums& datums);

/// The share that "2 %" is.
std::optional<double> share_from_text(std::string_view text);

}  // namespace pneuservo
