// Objects of JSON and dictionaries of Python in a line of text.
#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "record/foreign/named_values.hpp"

namespace pneuservo {

/// The values of the object that the text is, a comma behind it or not; none where it is no object. Names hold their
/// path with points between, numbers of a list count from one. A value beside its unit bears the name of both.
std::optional<std::vector<NamedValue>> values_of_object(std::string_view text);

}  // namespace pneuservo
