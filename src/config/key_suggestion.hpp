// What a wrong key was meant to be: the nearest known name, or the known name with another unit.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/core/field.hpp>

namespace pneuservo {

/// Edits (insert, delete, replace, swap of neighbours) that turn one word into the other.
int edit_distance(std::string_view a, std::string_view b);

/// Known names within reach of a typing error, nearest first, at most three.
std::vector<std::string> near_names(std::string_view wrong, const std::vector<std::string>& known);

/// Ending that a unit gives a key: "Pa" -> "_Pa", "m2/V" -> "_m2_per_V", "m/s" -> "_mps"; empty for pure numbers.
std::string unit_suffix(std::string_view unit);

/// The field that `wrong` names with another unit or none (length_mm, length -> length_m); null where there is none.
const Field* field_of_other_unit(std::string_view wrong, std::span<const Field> fields);

/// What stands after "expected" for an unknown key: the key in its own unit, the nearest ones, or all.
std::string expected_keys(std::string_view wrong, std::span<const Field> fields);
/// The same for names without unit (effects, paths).
std::string expected_names(std::string_view wrong, const std::vector<std::string>& known);

}  // namespace pneuservo
