// Numbers as text: strict reading, and the shortest decimal that reads back to the same bits.
#include "config/number_text.hpp"

#include <charconv>
#include <cmath>
#include <limits>

namespace pneuservo {

std::optional<double> number_from_text(std::string_view text) {
  const bool negative = !text.empty() && text.front() == '-';
  const std::string_view digits = !text.empty() && (negative || text.front() == '+') ? text.substr(1) : text;
  if (digits == ".inf" || digits == ".Inf" || digits == ".INF")
    return negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
  if (text == ".nan" || text == ".NaN" || text == ".NAN") return std::numeric_limits<double>::quiet_NaN();
  // from_chars also takes "inf", "nan" and a second sign; a number of YAML starts with a digit or a point.
  if (digits.empty() || !(digits.front() == '.' || (digits.front() >= '0' && digits.front() <= '9'))) return {};
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) return {};
  return negative ? -value : value;
}

std::string number_text(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value < 0 ? "-.inf" : ".inf";
  char buffer[40];
  const double size = std::fabs(value);
  const bool readable = size == 0.0 || (size >= 1e-4 && size < 1e7);
  const auto format = readable ? std::chars_format::fixed : std::chars_format::scientific;
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value, format);
  std::string text(buffer, end);
  // A point in the mantissa makes it a number for readers of YAML 1.1 too.
  const std::size_t exponent = text.find('e');
  if (exponent != std::string::npos && text.find('.') == std::string::npos) text.insert(exponent, ".0");
  return text;
}

}  // namespace pneuservo
