// Units as loggers write them, and what they are in SI.
#include "record/foreign/units.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

#include "record/foreign/field_text.hpp"

namespace pneuservo {

namespace {

constexpr double psi_Pa = 6894.757, torr_Pa = 133.322, water_Pa_per_mm = 9.80665, pound_N = 4.4482216;
/// Of air: normal (DIN 1343: 0 degC, 101325 Pa) and free (ISO 8778: 20 degC, 1 bar), which flow meters count in.
constexpr double normal_kgpm3 = 101325 / (287 * 273.15), free_kgpm3 = 1e5 / (287 * 293.15);
/// Where letters' size decides, the first one that fits counts.
constexpr std::array<Unit, 198> units{{{"s", Quantity::time, 1},
                                       {"sec", Quantity::time, 1},
                                       {"secs", Quantity::time, 1},
                                       {"second", Quantity::time, 1},
                                       {"seconds", Quantity::time, 1},
                                       {"ms", Quantity::time, 1e-3},
                                       {"msec", Quantity::time, 1e-3},
                                       {"millis", Quantity::time, 1e-3},
                                       {"millisecond", Quantity::time, 1e-3},
                                       {"milliseconds", Quantity::time, 1e-3},
                                       {"us", Quantity::time, 1e-6},
                                       {"\u00b5s", Quantity::time, 1e-6},
                                       {"\u03bcs", Quantity::time, 1e-6},
                                       {"usec", Quantity::time, 1e-6},
                                       {"micros", Quantity::time, 1e-6},
                                       {"microsecond", Quantity::time, 1e-6},
                                       {"microseconds", Quantity::time, 1e-6},
                                       {"ns", Quantity::time, 1e-9},
                                       {"nanosecond", Quantity::time, 1e-9},
                                       {"nanoseconds", Quantity::time, 1e-9},
                                       {"min", Quantity::time, 60},
                                       {"minute", Quantity::time, 60},
                                       {"minutes", Quantity::time, 60},
                                       {"h", Quantity::time, 3600},
                                       {"hr", Quantity::time, 3600},
                                       {"hour", Quantity::time, 3600},
                                       {"hours", Quantity::time, 3600},
                                       {"d", Quantity::time, 86400},
                                       {"day", Quantity::time, 86400},
                                       {"days", Quantity::time, 86400},
                                       {"seconde", Quantity::time, 1},
                                       {"secondes", Quantity::time, 1},
                                       {"segundo", Quantity::time, 1},
                                       {"segundos", Quantity::time, 1},
                                       {"secondo", Quantity::time, 1},
                                       {"secondi", Quantity::time, 1},
                                       {"sek", Quantity::time, 1},
                                       {"sekunde", Quantity::time, 1},
                                       {"sekunden", Quantity::time, 1},
                                       {"millisekunde", Quantity::time, 1e-3},
                                       {"millisekunden", Quantity::time, 1e-3},
                                       {"mikrosekunde", Quantity::time, 1e-6},
                                       {"mikrosekunden", Quantity::time, 1e-6},
                                       {"minuten", Quantity::time, 60},
                                       {"stunde", Quantity::time, 3600},
                                       {"stunden", Quantity::time, 3600},
                                       {"m", Quantity::length, 1},
                                       {"meter", Quantity::length, 1},
                                       {"meters", Quantity::length, 1},
                                       {"metre", Quantity::length, 1},
                                       {"metres", Quantity::length, 1},
                                       {"dm", Quantity::length, 1e-1},
                                       {"cm", Quantity::length, 1e-2},
                                       {"mm", Quantity::length, 1e-3},
                                       {"\u339c", Quantity::length, 1e-3},
                                       {"millimeter", Quantity::length, 1e-3},
                                       {"millimeters", Quantity::length, 1e-3},
                                       {"millimetre", Quantity::length, 1e-3},
                                       {"millimetres", Quantity::length, 1e-3},
                                       {"um", Quantity::length, 1e-6},
                                       {"\u00b5m", Quantity::length, 1e-6},
                                       {"\u03bcm", Quantity::length, 1e-6},
                                       {"micron", Quantity::length, 1e-6},
                                       {"microns", Quantity::length, 1e-6},
                                       {"micrometer", Quantity::length, 1e-6},
                                       {"micrometre", Quantity::length, 1e-6},
                                       {"nm", Quantity::length, 1e-9},
                                       {"in", Quantity::length, 0.0254},
                                       {"inch", Quantity::length, 0.0254},
                                       {"inches", Quantity::length, 0.0254},
                                       {"mil", Quantity::length, 25.4e-6},
                                       {"mils", Quantity::length, 25.4e-6},
                                       {"thou", Quantity::length, 25.4e-6},
                                       {"Zoll", Quantity::length, 0.0254},
                                       {"ft", Quantity::length, 0.3048},
                                       {"feet", Quantity::length, 0.3048},
                                       {"Pa", Quantity::pressure, 1},
                                       {"pascal", Quantity::pressure, 1},
                                       {"hPa", Quantity::pressure, 100},
                                       {"mbar", Quantity::pressure, 100},
                                       {"kPa", Quantity::pressure, 1e3},
                                       {"dbar", Quantity::pressure, 1e4},
                                       {"bar", Quantity::pressure, 1e5},
                                       {"MPa", Quantity::pressure, 1e6},
                                       {"N/mm2", Quantity::pressure, 1e6},
                                       {"N/m2", Quantity::pressure, 1},
                                       {"N/cm2", Quantity::pressure, 1e4},
                                       {"kN/m2", Quantity::pressure, 1e3},
                                       {"lbf/in2", Quantity::pressure, psi_Pa},
                                       {"lb/in2", Quantity::pressure, psi_Pa},
                                       {"at", Quantity::pressure, 98066.5},
                                       {"kp/cm2", Quantity::pressure, 98066.5},
                                       {"mmWS", Quantity::pressure, water_Pa_per_mm},
                                       {"mmH2O", Quantity::pressure, water_Pa_per_mm},
                                       {"cmH2O", Quantity::pressure, 10 * water_Pa_per_mm},
                                       {"mWS", Quantity::pressure, 1e3 * water_Pa_per_mm},
                                       {"mH2O", Quantity::pressure, 1e3 * water_Pa_per_mm},
                                       {"inH2O", Quantity::pressure, 25.4 * water_Pa_per_mm},
                                       {"psi", Quantity::pressure, psi_Pa},
                                       {"kgf/cm2", Quantity::pressure, 98066.5},
                                       {"kg/cm2", Quantity::pressure, 98066.5},
                                       {"atm", Quantity::pressure, 101325},
                                       {"Torr", Quantity::pressure, torr_Pa},
                                       {"mmHg", Quantity::pressure, torr_Pa},
                                       {"inHg", Quantity::pressure, 25.4 * torr_Pa},
                                       {"V", Quantity::voltage, 1},
                                       {"volt", Quantity::voltage, 1},
                                       {"volts", Quantity::voltage, 1},
                                       {"VDC", Quantity::voltage, 1},
                                       {"mV", Quantity::voltage, 1e-3},
                                       {"uV", Quantity::voltage, 1e-6},
                                       {"\u00b5V", Quantity::voltage, 1e-6},
                                       {"\u03bcV", Quantity::voltage, 1e-6},
                                       {"N", Quantity::force, 1},
                                       {"newton", Quantity::force, 1},
                                       {"newtons", Quantity::force, 1},
                                       {"mN", Quantity::force, 1e-3},
                                       {"daN", Quantity::force, 10},
                                       {"kN", Quantity::force, 1e3},
                                       {"lbf", Quantity::force, pound_N},
                                       {"kgf", Quantity::force, 9.80665},
                                       {"kp", Quantity::force, 9.80665},
                                       {"kg/s", Quantity::mass_flow, 1},
                                       {"g/s", Quantity::mass_flow, 1e-3},
                                       {"kg/h", Quantity::mass_flow, 1.0 / 3600},
                                       {"Nl/min", Quantity::mass_flow, normal_kgpm3 / 60e3},
                                       {"Nm3/h", Quantity::mass_flow, normal_kgpm3 / 3600},
                                       {"l/min", Quantity::mass_flow, free_kgpm3 / 60e3},
                                       {"l/s", Quantity::mass_flow, free_kgpm3 / 1e3},
                                       {"m3/h", Quantity::mass_flow, free_kgpm3 / 3600},
                                       {"\u79d2", Quantity::time, 1},
                                       {"\u6beb\u79d2", Quantity::time, 1e-3},
                                       {"\u7c73", Quantity::length, 1},
                                       {"\u6beb\u7c73", Quantity::length, 1e-3},
                                       {"\u5fae\u7c73", Quantity::length, 1e-6},
                                       {"\u5e15", Quantity::pressure, 1},
                                       {"\u5343\u5e15", Quantity::pressure, 1e3},
                                       {"\u5146\u5e15", Quantity::pressure, 1e6},
                                       {"\u5df4", Quantity::pressure, 1e5},
                                       {"\u4f0f", Quantity::voltage, 1},
                                       {"\u6beb\u4f0f", Quantity::voltage, 1e-3},
                                       {"\u725b", Quantity::force, 1},
                                       {"\ucd08", Quantity::time, 1},
                                       {"\u0441", Quantity::time, 1},
                                       {"\u0441\u0435\u043a", Quantity::time, 1},
                                       {"\u043c\u0441", Quantity::time, 1e-3},
                                       {"\u043c\u043a\u0441", Quantity::time, 1e-6},
                                       {"\u043c", Quantity::length, 1},
                                       {"\u0441\u043c", Quantity::length, 1e-2},
                                       {"\u043c\u043c", Quantity::length, 1e-3},
                                       {"\u041f\u0430", Quantity::pressure, 1},
                                       {"\u043a\u041f\u0430", Quantity::pressure, 1e3},
                                       {"\u041c\u041f\u0430", Quantity::pressure, 1e6},
                                       {"\u0431\u0430\u0440", Quantity::pressure, 1e5},
                                       {"\u0412", Quantity::voltage, 1},
                                       {"\u043c\u0412", Quantity::voltage, 1e-3},
                                       {"\u041d", Quantity::force, 1},
                                       {"\u043a\u041d", Quantity::force, 1e3},
                                       {"-", Quantity::raw, 1},
                                       {"1", Quantity::raw, 1},
                                       {"%", Quantity::raw, 1},
                                       {"A", Quantity::raw, 1},
                                       {"mA", Quantity::raw, 1},
                                       {"count", Quantity::raw, 1},
                                       {"counts", Quantity::raw, 1},
                                       {"\u2030", Quantity::raw, 0.1},
                                       {"promille", Quantity::raw, 0.1},
                                       {"permille", Quantity::raw, 0.1},
                                       {"inc", Quantity::raw, 1},
                                       {"incr", Quantity::raw, 1},
                                       {"increments", Quantity::raw, 1},
                                       {"inkremente", Quantity::raw, 1},
                                       {"digit", Quantity::raw, 1},
                                       {"digits", Quantity::raw, 1},
                                       {"LSB", Quantity::raw, 1},
                                       {"pulse", Quantity::raw, 1},
                                       {"pulses", Quantity::raw, 1},
                                       {"impulse", Quantity::raw, 1},
                                       {"tick", Quantity::raw, 1},
                                       {"ticks", Quantity::raw, 1},
                                       {"steps", Quantity::raw, 1},
                                       {"cts", Quantity::raw, 1},
                                       {"bool", Quantity::raw, 1},
                                       {"\u00b0C", Quantity::other, 1},
                                       {"degC", Quantity::other, 1},
                                       {"K", Quantity::other, 1},
                                       {"rad", Quantity::other, 1},
                                       {"deg", Quantity::other, 1},
                                       {"\u00b0", Quantity::other, 1},
                                       {"m/s", Quantity::other, 1},
                                       {"mm/s", Quantity::other, 1},
                                       {"m/s2", Quantity::other, 1},
                                       {"mm/s2", Quantity::other, 1},
                                       {"W", Quantity::other, 1},
                                       {"kW", Quantity::other, 1},
                                       {"Nm", Quantity::other, 1},
                                       {"Hz", Quantity::other, 1},
                                       {"kg", Quantity::other, 1}}};

/// Without blanks, brackets, underscores and a point at the end; raised digits are plain ones.
std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (std::string_view(" ()[]_").find(c) == std::string_view::npos) out += c;
  for (const std::string_view raised : {"\u00b2", "^2"})
    if (const std::size_t at = out.find(raised); at != std::string::npos) out.replace(at, raised.size(), "2");
  // What other encodings leave of the one prefix beyond ASCII.
  for (const std::string_view garbled : {"\u00c2\u00b5", "\u00e6", "\ufffd", "?", "&micro;", "&mu;"})
    if (out.starts_with(garbled) && out.size() > garbled.size()) out.replace(0, garbled.size(), "u");
  if (out.size() > 1 && out.ends_with('.')) out.pop_back();
  return out;
}

bool is_per_cent(std::string_view name) {
  constexpr std::array<std::string_view, 10> words{"pct",     "perc",    "percent",  "percentage", "percents",
                                                   "prozent", "procent", "pourcent", "porcentaje", "percentuale"};
  return std::ranges::find(words, in_small_letters(name)) != words.end();
}

bool is_alike(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char one, unsigned char other) { return std::tolower(one) == std::tolower(other); });
}

std::optional<Unit> listed(std::string_view name) {
  auto at = std::find_if(units.begin(), units.end(), [&](const Unit& unit) { return unit.name == name; });
  if (at == units.end())
    at = std::find_if(units.begin(), units.end(), [&](const Unit& unit) { return is_alike(unit.name, name); });
  return at == units.end() ? std::nullopt : std::optional(*at);
}

/// "barg", "bar rel", "kPa gauge" and "MPa abs": a pressure with a word for its zero behind it. A length's zero is
/// judged by the stroke: there a word for it says no more.
std::optional<Unit> unit_with_zero(std::string_view name) {
  constexpr std::array<std::string_view, 8> gauge{"gauge", "relative", "relativ", "rel",
                                                  "g",     "\u00fc",   "\u00dc",  "eff"};
  constexpr std::array<std::string_view, 4> absolute{"absolute", "absolut", "abs", "a"};
  const auto with = [&](std::string_view word, bool is_gauge) -> std::optional<Unit> {
    if (name.size() <= word.size() || !is_alike(name.substr(name.size() - word.size()), word)) return std::nullopt;
    std::string_view before = name.substr(0, name.size() - word.size());
    while (before.ends_with('-') || before.ends_with(',') || before.ends_with('.')) before.remove_suffix(1);
    std::optional<Unit> unit = listed(before);
    if (unit && unit->quantity == Quantity::length && word.size() >= 3) return unit;
    if (!unit || unit->quantity != Quantity::pressure) return std::nullopt;
    unit->is_gauge = is_gauge;
    unit->is_absolute = !is_gauge;
    return unit;
  };
  for (const std::string_view word : gauge)
    if (const auto unit = with(word, true)) return unit;
  for (const std::string_view word : absolute)
    if (const auto unit = with(word, false)) return unit;
  return std::nullopt;
}

/// A listed unit that may be counted in multiples.
std::optional<Unit> measure(std::string_view name) {
  std::optional<Unit> unit = listed(name);
  if (!unit) unit = unit_with_zero(name);
  return unit && unit->quantity < Quantity::raw ? unit : std::nullopt;
}

/// "mm/10", "mm*100", "mm x 10": values that are so many times those in the unit.
std::optional<Unit> divided(std::string_view name) {
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  double times = 0;
  std::from_chars(name.data() + digits, name.data() + name.size(), times);
  std::string_view before = name.substr(0, digits);
  for (const std::string_view sign : {"/", "*", "x", "X", "\u00d7"}) {
    if (!before.ends_with(sign) || !(times > 1) || !is_power_of_ten(times)) continue;
    std::optional<Unit> unit = measure(before.substr(0, before.size() - sign.size()));
    if (unit) unit->factor /= times, unit->is_multiple = true;
    return unit;
  }
  return std::nullopt;
}

/// "0.1 mm", "0,01 mm", "1e-3 m", "10^-3 m", "1/1000 m", "x100 us": a power of ten before a unit, of a time any number;
/// none where there is no such.
std::optional<Unit> multiple(std::string text) {
  for (const std::string_view sign : {"x", "*", "\u00d7"})
    if (text.starts_with(sign) && text.size() > sign.size()) text.erase(0, sign.size());
  if (text.starts_with("10^")) text.replace(0, 3, "1e");
  if (const std::size_t comma = text.find(','); comma != std::string::npos) text[comma] = '.';
  const std::string_view name = text;
  double factor = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), factor);
  std::string_view rest = name.substr(static_cast<std::size_t>(end - name.data()));
  if (error != std::errc() || !(factor > 0) || rest.empty()) return std::nullopt;
  double under = 1;
  if (rest.starts_with('/')) {
    const auto [stop, wrong] = std::from_chars(rest.data() + 1, rest.data() + rest.size(), under);
    if (wrong != std::errc() || !(under > 0)) return std::nullopt;
    rest.remove_prefix(static_cast<std::size_t>(stop - rest.data()));
  }
  if (rest.starts_with('*')) rest.remove_prefix(1);
  std::optional<Unit> unit = measure(rest);
  if (!unit || !(unit->quantity == Quantity::time || is_power_of_ten(factor / under))) return std::nullopt;
  unit->factor *= factor / under;
  unit->is_multiple = factor != under;
  return unit;
}

/// "-10..10 V", "0-10 bar", "+/-10 V": the sensor's range stands before the unit.
std::optional<Unit> behind_range(std::string name) {
  bool is_range = false;
  for (const std::string_view sign : {"\u00b1", "+/-", "+-"})
    if (name.starts_with(sign)) is_range = true, name.erase(0, sign.size());
  const auto number_end = [&](std::size_t at) {
    if (at < name.size() && (name[at] == '-' || name[at] == '+')) ++at;
    const std::size_t begin = at;
    while (at < name.size() && std::isdigit(static_cast<unsigned char>(name[at]))) ++at;
    return at == begin ? std::string::npos : at;
  };
  std::size_t end = number_end(0);
  if (end == std::string::npos) return std::nullopt;
  for (const std::string_view between : {"...", "..", "-", "\u2013", "to", "bis", "~"}) {
    if (is_range || name.compare(end, between.size(), between) != 0) continue;
    end = number_end(end + between.size());
    if (end == std::string::npos) return std::nullopt;
    is_range = true;
  }
  return is_range ? measure(std::string_view(name).substr(end)) : std::nullopt;
}

}  // namespace

std::optional<double> factor_between(std::string_view from, std::string_view to) {
  const std::optional<Unit> own = unit_in(from), other = unit_in(to);
  if (!own || !other || own->quantity != other->quantity || own->is_gauge != other->is_gauge) return std::nullopt;
  return own->factor / other->factor;
}

bool is_power_of_ten(double number) {
  const double power = std::log10(number);
  return std::abs(power - std::round(power)) < 1e-9;  // not of NaN and infinity
}

bool is_unit_word(std::string_view word) {
  constexpr std::array<std::string_view, 15> words{"unit",   "units",   "unite",        "unit\u00e9",   "unita",
                                                   "unidad", "einheit", "eenheid",      "enhet",        "engunits",
                                                   "eu",     "uom",     "\u5358\u4f4d", "\u5355\u4f4d", "\ub2e8\uc704"};
  return std::ranges::find(words, in_small_letters(word)) != words.end();
}

std::string_view without_brackets(std::string_view text) {
  text = trimmed(text);
  const bool is_in_brackets =
      text.size() >= 2 && ((text.front() == '[' && text.back() == ']') || (text.front() == '(' && text.back() == ')') ||
                           (text.front() == '<' && text.back() == '>') || (text.front() == '{' && text.back() == '}'));
  return is_in_brackets ? trimmed(text.substr(1, text.size() - 2)) : text;
}

std::optional<Unit> unit_in(std::string_view text) {
  const std::string name = plain(without_brackets(half_width(text)));
  if (name.empty()) return std::nullopt;
  if (const auto unit = listed(name)) return unit;
  if (const auto unit = unit_with_zero(name)) return unit;
  if (name == "\"") return listed("in");
  if (is_per_cent(name)) return listed("%");
  if (const auto unit = divided(name)) return unit;
  if (const auto unit = behind_range(name)) return unit;
  return multiple(name);
}

std::size_t unit_start(std::string_view field) {
  std::size_t start = field.find_last_of(" \t");
  start = start == std::string_view::npos ? field.find_last_of("0123456789.,") + 1 : start + 1;
  if (start == 0 || start >= field.size()) return field.size();
  const std::string_view unit = field.substr(start);
  return unit != "1" && unit != "-" && listed(unit) ? start : field.size();
}

}  // namespace pneuservo
