// Units as loggers write them, and what they are in SI.
#include "record/units.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "record/field_text.hpp"

namespace pneuservo {

namespace {

constexpr double psi_Pa = 6894.757, pound_N = 4.4482216;
/// Where letters' size decides, the first one that fits counts.
constexpr std::array<Unit, 69> units{{{"s", Quantity::time, 1},
                                      {"sec", Quantity::time, 1},
                                      {"secs", Quantity::time, 1},
                                      {"second", Quantity::time, 1},
                                      {"seconds", Quantity::time, 1},
                                      {"ms", Quantity::time, 1e-3},
                                      {"msec", Quantity::time, 1e-3},
                                      {"milliseconds", Quantity::time, 1e-3},
                                      {"us", Quantity::time, 1e-6},
                                      {"\u00b5s", Quantity::time, 1e-6},
                                      {"\u03bcs", Quantity::time, 1e-6},
                                      {"microseconds", Quantity::time, 1e-6},
                                      {"ns", Quantity::time, 1e-9},
                                      {"nanoseconds", Quantity::time, 1e-9},
                                      {"min", Quantity::time, 60},
                                      {"m", Quantity::length, 1},
                                      {"meters", Quantity::length, 1},
                                      {"metres", Quantity::length, 1},
                                      {"cm", Quantity::length, 1e-2},
                                      {"mm", Quantity::length, 1e-3},
                                      {"millimeters", Quantity::length, 1e-3},
                                      {"millimetres", Quantity::length, 1e-3},
                                      {"um", Quantity::length, 1e-6},
                                      {"\u00b5m", Quantity::length, 1e-6},
                                      {"\u03bcm", Quantity::length, 1e-6},
                                      {"in", Quantity::length, 0.0254},
                                      {"inches", Quantity::length, 0.0254},
                                      {"Pa", Quantity::pressure, 1},
                                      {"pascal", Quantity::pressure, 1},
                                      {"hPa", Quantity::pressure, 100},
                                      {"mbar", Quantity::pressure, 100},
                                      {"kPa", Quantity::pressure, 1e3},
                                      {"bar", Quantity::pressure, 1e5},
                                      {"bara", Quantity::pressure, 1e5},
                                      {"barg", Quantity::pressure, 1e5, true},
                                      {"MPa", Quantity::pressure, 1e6},
                                      {"psi", Quantity::pressure, psi_Pa},
                                      {"psia", Quantity::pressure, psi_Pa},
                                      {"psig", Quantity::pressure, psi_Pa, true},
                                      {"V", Quantity::voltage, 1},
                                      {"volt", Quantity::voltage, 1},
                                      {"volts", Quantity::voltage, 1},
                                      {"mV", Quantity::voltage, 1e-3},
                                      {"N", Quantity::force, 1},
                                      {"newton", Quantity::force, 1},
                                      {"newtons", Quantity::force, 1},
                                      {"daN", Quantity::force, 10},
                                      {"kN", Quantity::force, 1e3},
                                      {"lbf", Quantity::force, pound_N},
                                      {"-", Quantity::raw, 1},
                                      {"1", Quantity::raw, 1},
                                      {"%", Quantity::raw, 1},
                                      {"\u00b0C", Quantity::other, 1},
                                      {"degC", Quantity::other, 1},
                                      {"K", Quantity::other, 1},
                                      {"A", Quantity::raw, 1},
                                      {"mA", Quantity::raw, 1},
                                      {"rad", Quantity::other, 1},
                                      {"deg", Quantity::other, 1},
                                      {"\u00b0", Quantity::other, 1},
                                      {"m/s", Quantity::other, 1},
                                      {"mm/s", Quantity::other, 1},
                                      {"kg/s", Quantity::other, 1},
                                      {"l/min", Quantity::other, 1},
                                      {"Hz", Quantity::other, 1},
                                      {"kg", Quantity::other, 1},
                                      {"count", Quantity::raw, 1},
                                      {"counts", Quantity::raw, 1},
                                      {"bool", Quantity::raw, 1}}};

/// Without blanks, brackets and underscores: "bar (g)", "bar_g" and "bar abs" are barg and bara.
std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (std::string_view(" ()[]_").find(c) == std::string_view::npos) out += c;
  if (out.ends_with("abs")) out.resize(out.size() - 2);
  return out;
}

bool is_alike(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char one, unsigned char other) { return std::tolower(one) == std::tolower(other); });
}

}  // namespace

std::string_view without_brackets(std::string_view text) {
  text = trimmed(text);
  const bool is_in_brackets =
      text.size() >= 2 && ((text.front() == '[' && text.back() == ']') || (text.front() == '(' && text.back() == ')') ||
                           (text.front() == '<' && text.back() == '>'));
  return is_in_brackets ? trimmed(text.substr(1, text.size() - 2)) : text;
}

const Unit* unit_in(std::string_view text) {
  const std::string name = plain(without_brackets(text));
  auto at = std::find_if(units.begin(), units.end(), [&](const Unit& unit) { return unit.name == name; });
  if (at == units.end())
    at = std::find_if(units.begin(), units.end(), [&](const Unit& unit) { return is_alike(unit.name, name); });
  return at == units.end() ? nullptr : &*at;
}

std::size_t unit_start(std::string_view field) {
  const std::size_t blank = field.find_last_of(" \t");
  if (blank == std::string_view::npos || blank == 0) return field.size();
  const std::string_view unit = field.substr(blank + 1);
  return unit != "1" && unit != "-" && unit_in(unit) != nullptr ? blank + 1 : field.size();
}

}  // namespace pneuservo
