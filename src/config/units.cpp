// Numbers with units as data sheets write them (3.5 m, 6 bar gauge, 700 l/min), read into the SI unit of a field.
#include "config/units.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "config/key_suggestion.hpp"
#include "config/number_text.hpp"

namespace pneuservo {

namespace {

struct Symbol {
  std::string_view name;
  Dimension dimension;
  double numerator = 1.0;
  int exponent = 0;
  bool takes_prefix = false;
};

constexpr double degrees_per_rad = 180.0 / std::numbers::pi;
/// Free air (ISO 8778: 20 degC, 1 bar) that a normal litre (DIN 1343: 0 degC, 1.01325 bar) is.
constexpr double free_per_normal = 293.15 / 273.15 * 1.01325;

//                            m  kg  s  K  V  A rad
constexpr std::array symbols{
    Symbol{"m", {1, 0, 0, 0, 0, 0, 0}, 1, 0, true},
    Symbol{"in", {1, 0, 0, 0, 0, 0, 0}, 254, -4},
    Symbol{"ft", {1, 0, 0, 0, 0, 0, 0}, 3048, -4},
    Symbol{"g", {0, 1, 0, 0, 0, 0, 0}, 1, -3, true},
    Symbol{"lb", {0, 1, 0, 0, 0, 0, 0}, 45359237, -8},
    Symbol{"s", {0, 0, 1, 0, 0, 0, 0}, 1, 0, true},
    Symbol{"min", {0, 0, 1, 0, 0, 0, 0}, 60},
    Symbol{"h", {0, 0, 1, 0, 0, 0, 0}, 3600},
    Symbol{"Hz", {0, 0, -1, 0, 0, 0, 0}, 1, 0, true},
    Symbol{"K", {0, 0, 0, 1, 0, 0, 0}},
    Symbol{"V", {0, 0, 0, 0, 1, 0, 0}, 1, 0, true},
    Symbol{"A", {0, 0, 0, 0, 0, 1, 0}, 1, 0, true},
    Symbol{"ohm", {0, 0, 0, 0, 1, -1, 0}, 1, 0, true},
    Symbol{"\u03a9", {0, 0, 0, 0, 1, -1, 0}, 1, 0, true},
    Symbol{"rad", {0, 0, 0, 0, 0, 0, 1}, 1, 0, true},
    Symbol{"N", {1, 1, -2, 0, 0, 0, 0}, 1, 0, true},
    Symbol{"lbf", {1, 1, -2, 0, 0, 0, 0}, 4.4482216152605},
    Symbol{"kp", {1, 1, -2, 0, 0, 0, 0}, 980665, -5},
    Symbol{"Pa", {-1, 1, -2, 0, 0, 0, 0}, 1, 0, true},
    Symbol{"bar", {-1, 1, -2, 0, 0, 0, 0}, 1, 5, true},
    Symbol{"psi", {-1, 1, -2, 0, 0, 0, 0}, 6894.757293168},
    Symbol{"J", {2, 1, -2, 0, 0, 0, 0}, 1, 0, true},
    Symbol{"W", {2, 1, -3, 0, 0, 0, 0}, 1, 0, true},
    Symbol{"l", {3, 0, 0, 0, 0, 0, 0}, 1, -3, true},
    Symbol{"L", {3, 0, 0, 0, 0, 0, 0}, 1, -3, true},
    Symbol{"Nl", {3, 0, 0, 0, 0, 0, 0}, free_per_normal, -3},
    Symbol{"NL", {3, 0, 0, 0, 0, 0, 0}, free_per_normal, -3},
    Symbol{"ccm", {3, 0, 0, 0, 0, 0, 0}, 1, -6},
    Symbol{"1", {}},
};
/// Units whose factor is no decimal are divided by it.
constexpr std::array divided_symbols{Symbol{"deg", {0, 0, 0, 0, 0, 0, 1}, degrees_per_rad},
                                     Symbol{"\u00b0", {0, 0, 0, 0, 0, 0, 1}, degrees_per_rad}};

struct Prefix {
  std::string_view name;
  int exponent;
};
constexpr std::array prefixes{Prefix{"M", 6},       Prefix{"k", 3},  Prefix{"h", 2},  Prefix{"d", -1},
                              Prefix{"c", -2},      Prefix{"m", -3}, Prefix{"u", -6}, Prefix{"\u00b5", -6},
                              Prefix{"\u03bc", -6}, Prefix{"n", -9}};

UnitOfMeasure unit_of(const Symbol& symbol, int prefix_exponent) {
  return {symbol.dimension, symbol.numerator, 1.0, symbol.exponent + prefix_exponent};
}

std::optional<UnitOfMeasure> find_symbol(std::string_view name) {
  const auto listed = [&](std::string_view text) { return std::ranges::find(symbols, text, &Symbol::name); };
  if (const auto symbol = listed(name); symbol != symbols.end()) return unit_of(*symbol, 0);
  if (const auto symbol = std::ranges::find(divided_symbols, name, &Symbol::name); symbol != divided_symbols.end())
    return UnitOfMeasure{symbol->dimension, 1.0, symbol->numerator, 0};
  for (const Prefix& prefix : prefixes) {
    if (!name.starts_with(prefix.name)) continue;
    const auto symbol = listed(name.substr(prefix.name.size()));
    if (symbol != symbols.end() && symbol->takes_prefix) return unit_of(*symbol, prefix.exponent);
  }
  return {};
}

UnitOfMeasure to_power(const UnitOfMeasure& unit, int power) {
  UnitOfMeasure out;
  for (int i = 0; i < std::abs(power); ++i) {
    out.numerator *= power > 0 ? unit.numerator : unit.denominator;
    out.denominator *= power > 0 ? unit.denominator : unit.numerator;
  }
  out.exponent = unit.exponent * power;
  for (std::size_t i = 0; i < out.dimension.size(); ++i) out.dimension[i] = unit.dimension[i] * power;
  return out;
}

void multiply(UnitOfMeasure& by, const UnitOfMeasure& unit) {
  by.numerator *= unit.numerator, by.denominator *= unit.denominator, by.exponent += unit.exponent;
  for (std::size_t i = 0; i < by.dimension.size(); ++i) by.dimension[i] += unit.dimension[i];
}

/// Factors from left to right; a slash takes the one factor, or the bracket, behind it.
class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : rest_(text) {}
  std::optional<UnitOfMeasure> parse() {
    auto unit = product();
    return unit && rest_.empty() ? unit : std::nullopt;
  }

 private:
  static constexpr int most_factors = 8, largest_power = 4;

  void skip_spaces() {
    while (!rest_.empty() && rest_.front() == ' ') rest_.remove_prefix(1);
  }
  bool take(std::string_view sign) {
    skip_spaces();
    if (!rest_.starts_with(sign)) return false;
    rest_.remove_prefix(sign.size());
    return true;
  }
  std::optional<UnitOfMeasure> product() {
    auto unit = factor();
    while (unit) {
      skip_spaces();
      if (rest_.empty() || rest_.front() == ')') return unit;
      const bool divides = take("/");
      if (!divides && !take("*")) take("\u00b7");
      const auto next = factor();
      if (!next) return {};
      multiply(*unit, to_power(*next, divides ? -1 : 1));
    }
    return {};
  }
  std::optional<UnitOfMeasure> factor() {
    if (++factors_ > most_factors) return {};
    if (take("(")) {
      auto inner = product();
      return inner && take(")") ? inner : std::nullopt;
    }
    skip_spaces();
    const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) || (c & 0x80) != 0; };
    std::size_t size = 0;
    while (size < rest_.size() && is_letter(rest_[size]) && !is_raised(rest_.substr(size))) ++size;
    if (size == 0 && rest_.starts_with('1')) size = 1;
    const auto unit = find_symbol(rest_.substr(0, size));
    rest_.remove_prefix(size);
    return unit ? std::optional(to_power(*unit, power())) : std::nullopt;
  }
  /// Also the point of a product ends a symbol.
  static bool is_raised(std::string_view text) {
    return text.starts_with("\u00b2") || text.starts_with("\u00b3") || text.starts_with("\u00b7");
  }
  int power() {
    if (take("\u00b2")) return 2;
    if (take("\u00b3")) return 3;
    if (rest_.starts_with('^')) rest_.remove_prefix(1);
    int power = 1;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), power);
    if (error != std::errc{} || std::abs(power) > largest_power) return 1;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return power;
  }

  std::string_view rest_;
  int factors_ = 0;
};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// The decimal times a power of ten, rounded once.
std::optional<double> shifted_decimal(std::string_view number, int exponent) {
  if (!number_from_text(number)) return {};
  const std::size_t e = number.find_first_of("eE");
  int stated = 0;
  std::string_view mantissa = number.substr(0, e);
  if (e != std::string_view::npos) {
    std::string_view digits = number.substr(e + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    if (std::from_chars(digits.data(), digits.data() + digits.size(), stated).ec != std::errc{}) return {};
  }
  return number_from_text(fmt::format("{}e{}", mantissa, stated + exponent));
}

/// Number, unit and the words behind it.
struct Written {
  std::string_view number, unit, words;
};

/// Words that say what a value counts from, longest first.
constexpr std::array<std::string_view, 2> gauge_words{"gauge", "rel"};
constexpr std::array<std::string_view, 2> absolute_words{"absolute", "abs"};
constexpr std::array<std::string_view, 2> end_words{"from end 1", "from end 2"};

bool is_one_of(std::string_view text, const std::array<std::string_view, 2>& words) {
  return std::ranges::find(words, text) != words.end();
}

Written split(std::string_view text) {
  text = trimmed(text);
  std::size_t size = 0;
  const auto is_number = [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-'; };
  while (size < text.size() && is_number(text[size])) ++size;
  const bool has_exponent = size > 0 && size + 1 < text.size() && (text[size] == 'e' || text[size] == 'E') &&
                            is_number(text[size + 1]) && text[size + 1] != '.';
  if (has_exponent)
    for (++size; size < text.size() && is_number(text[size]);) ++size;
  Written written{text.substr(0, size), trimmed(text.substr(size)), ""};
  for (const auto& words : {gauge_words, absolute_words, end_words})
    for (const std::string_view word : words)
      if (written.unit.ends_with(word) && written.words.empty()) {
        written.unit = trimmed(written.unit.substr(0, written.unit.size() - word.size()));
        written.words = word;
      }
  return written;
}

std::optional<double> value_of(std::string_view number, const UnitOfMeasure& unit) {
  if (unit.numerator == 1.0 && unit.denominator == 1.0) return shifted_decimal(number, unit.exponent);
  const auto decimal = number_from_text(number);
  if (!decimal) return {};
  const double scaled = *decimal * unit.numerator / unit.denominator, power = std::pow(10.0, std::abs(unit.exponent));
  return unit.exponent < 0 ? scaled / power : scaled * power;
}

/// Whether the words fit what the field counts from; a pressure that counts from vacuum must say which it is.
bool fits_datum(const Field& field, const Written& written) {
  const Datum datum = datum_of(field);
  const bool is_pressure_word = is_one_of(written.words, gauge_words) || is_one_of(written.words, absolute_words);
  if (written.words.empty()) return datum != Datum::vacuum;
  if (field.unit == "Pa") return is_pressure_word;
  return datum == Datum::mid_stroke && is_one_of(written.words, end_words);
}

double from_datum(double value, std::string_view words, const Datums& datums) {
  if (is_one_of(words, gauge_words)) return value + datums.atmosphere_Pa;
  if (words == end_words[0]) return value - 0.5 * datums.stroke_m;
  if (words == end_words[1]) return 0.5 * datums.stroke_m - value;
  return value;
}

constexpr double ice_K = 273.15;
constexpr Dimension volume_flow{3, 0, -1, 0, 0, 0, 0}, mass_flow{0, 1, -1, 0, 0, 0, 0};

}  // namespace

std::optional<UnitOfMeasure> parse_unit(std::string_view text) { return UnitParser(trimmed(text)).parse(); }

Datum datum_of(const Field& field) {
  if (field.unit == "Pa" && field.minimum > 0.0) return Datum::vacuum;
  if (field.unit == "K") return Datum::absolute_zero;
  if (field.unit == "m" && field.minimum < 0.0) return Datum::mid_stroke;
  return Datum::none;
}

std::string_view key_without_unit(const Field& field) {
  if (!parse_unit(field.unit)) return "";
  const std::string suffix = unit_suffix(field.unit);
  if (suffix.empty() || !field.key.ends_with(suffix) || field.key.size() == suffix.size()) return "";
  return field.key.substr(0, field.key.size() - suffix.size());
}

std::string example_quantity(const Field& field) {
  switch (datum_of(field)) {
    case Datum::vacuum: return "a pressure with its zero (6 bar gauge, 7 bar absolute)";
    case Datum::absolute_zero: return "a temperature with its unit (20 degC, 293 K)";
    case Datum::mid_stroke:
      return "a position with its unit (20 mm, which counts from mid-stroke, or 20 mm from end 1)";
    case Datum::none: break;
  }
  std::string_view like = field.unit;
  if (field.unit == "m") like = "mm";
  if (field.unit == "Pa") like = "bar";
  if (field.unit == "m3") like = "cm3";
  if (field.unit == "m2") like = "mm2";
  if (field.unit == "s") like = "ms";
  if (field.unit == "kg/s") like = "Nl/min";
  const bool has_own = key_without_unit(field).empty();
  return fmt::format("a number with its unit ({}){}", like, has_own ? "" : fmt::format(", or the key {}", field.key));
}

ReadQuantity read_quantity(const Field& field, std::string_view text, const Datums& datums) {
  const Written written = split(text);
  const std::string expected = example_quantity(field);
  if (datum_of(field) == Datum::absolute_zero && (written.unit == "degC" || written.unit == "\u00b0C")) {
    const auto celsius = number_from_text(written.number);
    return {celsius ? std::optional(*celsius + ice_K) : std::nullopt, expected};
  }
  const auto unit = parse_unit(written.unit), own = parse_unit(field.unit);
  if (unit && own && unit->dimension == volume_flow && own->dimension == mass_flow && fits_datum(field, written)) {
    const auto value = value_of(written.number, *unit);
    return {value ? std::optional(*value * datums.free_air_kgpm3) : std::nullopt, expected};
  }
  if (!unit || !own || unit->dimension != own->dimension || !fits_datum(field, written)) return {{}, expected};
  if (is_one_of(written.words, end_words) && !(datums.stroke_m > 0.0))
    return {{}, "a position from mid-stroke: the stroke is not known"};
  const auto value = value_of(written.number, *unit);
  return {value ? std::optional(from_datum(*value, written.words, datums)) : std::nullopt, expected};
}

ReadRange read_range(const Field& field, std::string_view text, const Datums& datums) {
  const std::string expected =
      fmt::format("two ends with their unit (0 to 10 {})", field.unit == "Pa"     ? "bar gauge"
                                                           : field.unit == "m"    ? "mm"
                                                           : field.unit == "kg/s" ? "Nl/min"
                                                                                  : field.unit);
  const std::size_t to = text.find(" to ");
  if (to == std::string_view::npos) return {{}, expected};
  const std::string_view high_text = text.substr(to + 4);
  const Written last = split(high_text);
  std::string low_text(text.substr(0, to));
  if (split(low_text).unit.empty() && split(low_text).words.empty())
    low_text += fmt::format(" {} {}", last.unit, last.words);
  const auto low = read_quantity(field, low_text, datums), high = read_quantity(field, high_text, datums);
  if (!low.value || !high.value || *low.value == *high.value) return {{}, expected};
  return {std::array{*low.value, *high.value}, expected};
}

std::optional<double> share_from_text(std::string_view text) {
  text = trimmed(text);
  if (!text.ends_with('%')) return {};
  return shifted_decimal(trimmed(text.substr(0, text.size() - 1)), -2);
}

}  // namespace pneuservo
