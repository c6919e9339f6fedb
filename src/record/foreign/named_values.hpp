// Values that bear their names in a line of text: "x=0.5 mm; u=1", "Pressure A: 5.0 bar", {"x": 0.5}.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pneuservo {

struct NamedValue {
  std::string name;
  std::string value;  ///< a number with a point, a stamp or a text; empty: none
  std::string unit;   ///< behind the value; empty: none
};

/// How the lines of a file name their values.
struct PairStyle {
  enum class Kind {
    split,    ///< fields between separators are a name and a value each
    object,   ///< an object of JSON, or a dictionary of Python
    scanned,  ///< pairs stand anywhere in a text
  };
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  Kind kind = Kind::scanned;
  char separator = ',', sign = '=';  ///< of split lines: between pairs, and between name and value
  char decimal = '.';
  std::size_t stamp = none;  ///< which of the numbers before the first name is the time
};

/// What a stamp before or behind the pairs of a line is called.
inline constexpr std::string_view stamp_name = "Timestamp";

/// The values of a line. known: names whose value may be any text. None where the line has no such values, or where as
/// many numbers have no name: a table with remarks.
std::vector<NamedValue> values_in(std::string_view line, const PairStyle& style,
                                  const std::vector<std::string>& known = {});

/// A number before the first name of a line, with the unit behind it.
struct LooseNumber {
  double value;
  std::string_view text, unit;
};
std::vector<LooseNumber> numbers_before_names(std::string_view line, const PairStyle& style);

/// A number with a point in place of a decimal comma.
std::string with_point(std::string_view number, char decimal);

}  // namespace pneuservo
