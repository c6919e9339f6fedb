// Numbers as text: strict reading, and the shortest decimal that reads back to the same bits.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace pneuservo {

/// A decimal number ("-1.8e-5", "101325", ".inf", ".nan"); empty where the text is anything else or beyond double.
std::optional<double> number_from_text(std::string_view text);

/// Shortest text that reads back to the same bits; infinity is ".inf" and not-a-number ".nan", as in YAML.
std::string number_text(double value);

}  // namespace pneuservo
