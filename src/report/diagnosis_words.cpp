// What a diagnosis says, in a machine builder's words: effects, elements, sizes.
#include <report/diagnosis_words.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pneuservo {
namespace {

/// Without side or channel, which # stands for.
constexpr std::pair<std::string_view, std::string_view> words_of_effects[] = {
    {"coulomb_friction", "dry friction, the same at every speed"},
    {"stribeck_friction", "friction that is larger at low speed"},
    {"direction_dependent_friction", "dry friction that differs by direction"},
    {"pressure_dependent_friction", "friction that grows with the pressures (seals)"},
    {"friction_zone", "a tight spot of the guide"},
    {"quadratic_drag", "drag with the square of the speed"},
    {"direction_dependent_viscous_friction", "viscous friction that differs by direction"},
    {"viscous_friction", "viscous friction, the same both ways"},
    {"elastic_friction", "dry friction that builds up along the way where the motion turns (hysteresis)"},
    {"gravity_load", "a weight on a lever that turns with the axis"},
    {"pump_curve", "a supply whose pressure falls with its flow, as a pump's does"},
    {"laminar_leak", "a leak of chamber # through narrow ways"},
    {"porous_leak", "a leak of chamber # through a porous wall"},
    {"wall_heat_exchange", "heat between gas and wall"},
    {"charging_heat", "gas that charging has warmed and that cools"},
    {"drop_out_delay", "a valve that drops out later than it pulls in"},
    {"constant_force", "a constant force on the slider (weight, incline, cable)"},
    {"spring_load", "a spring on the slider"},
    {"elastic_load", "a load that swings on a soft coupling"},
    {"load_backlash", "a load that is coupled with play"},
    {"valve_dead_band", "a dead band of the valve (overlap)"},
    {"valve_offset", "an offset of the valve's neutral position"},
    {"valve_hysteresis", "play between command and spool"},
    {"valve_lag", "a lag between command and spool"},
    {"valve_neutral_leak", "a leak through the closed valve"},
    {"valve_asymmetry", "exhaust edges wider or narrower than supply edges"},
    {"valve_curve", "edges of the valve whose slope changes along the spool's way"},
    {"command_delay", "dead time between command and spool"},
    {"supply_droop", "supply pressure that gives way under flow"},
    {"line_restriction", "a narrow place where line # meets chamber #"},
    {"line_branch", "a dead-end branch of line # (a T-piece with a hose or a vessel)"},
    {"line_leak", "a leak from line # to the room"},
    {"chamber_leak", "a leak from chamber # to the room"},
    {"piston_leak", "a leak past the piston"},
    {"piston_leak_zone", "a leak past the piston about one place of its way"},
    {"sensor_offset", "an offset of the sensor of #"},
    {"sensor_gain", "a wrong gain of the sensor of #"},
    {"sensor_lag", "a lag of the sensor of #"},
    {"unknown", "something that no name explains"},
};

std::string with_side(std::string_view words, std::string_view side) {
  std::string out;
  for (const char c : words)
    if (c == '#') out += side;
    else out += c;
  return out;
}

struct HandyUnit {
  std::string_view ending, unit;
  double factor;
};
constexpr HandyUnit handy_units[] = {
    {"_m2", "mm²", 1e6}, {"_m3", "cm³", 1e6}, {"_kPa", "kPa", 1}, {"_Pa", "kPa", 1e-3}, {"_mps", "mm/s", 1e3},
    {"_m", "mm", 1e3},   {"_V", "mV", 1e3},   {"_kg", "kg", 1},   {"_Hz", "Hz", 1},     {"_s", "ms", 1e3}};

/// "coulomb force" for coulomb_force_N: the key without its unit.
std::string name_words(std::string_view key) {
  std::string words(key.substr(0, key.find_last_of('_')));
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

}  // namespace

std::string effect_words(std::string_view effect) {
  if (effect.starts_with("parameter:")) return fmt::format("{} is not what the config says", effect.substr(10));
  std::string_view name = effect, side;
  if (const auto colon = effect.find(':'); colon != std::string_view::npos) {
    name = effect.substr(0, colon);
    side = effect.substr(colon + 1);
  } else if (effect.ends_with("_1") || effect.ends_with("_2")) {
    name = effect.substr(0, effect.size() - 2);
    side = effect.substr(effect.size() - 1);
  }
  for (const auto& [key, words] : words_of_effects)
    if (key == name) return with_side(words, side);
  return std::string(effect);
}

std::string element_words(std::string_view element) {
  if (element.starts_with("sensor:")) return fmt::format("sensor of {}", element.substr(7));
  if (element.starts_with("line_") || element.starts_with("chamber_"))
    return fmt::format("{} {}", element.substr(0, element.size() - 2), element.substr(element.size() - 1));
  if (element == "timing") return "timing of the command";
  if (element == "motion") return "slider, guide and load";
  return std::string(element);
}

std::string size_words(std::string_view key, double value) {
  if (!std::isfinite(value) || key.find("_per_") != std::string_view::npos) return "";
  for (const HandyUnit& handy : handy_units) {
    if (!key.ends_with(handy.ending)) continue;
    std::string words = fmt::format("{:.4g} {}", value * handy.factor, handy.unit);
    if (handy.unit == "mm²" && value > 0)  // the effective area of a sharp hole is about 0.6 of its own
      words += fmt::format(", about a hole of {:.2g} mm", 2e3 * std::sqrt(value / (0.6 * M_PI)));
    return words;
  }
  return "";
}

std::string verdict_words(const Diagnosis& diagnosis) {
  if (diagnosis.stopped || diagnosis.answers.empty() || diagnosis.verdict == Verdict::consistent ||
      diagnosis.verdict == Verdict::unknown)
    return diagnosis.sentence;
  std::vector<std::string> parts;
  for (const DiagnosisAnswer& answer : diagnosis.answers) {
    std::string part = effect_words(answer.effect), size;
    for (const EstimatedParameter& p : answer.parameters) {
      const std::string_view key = p.name == "value" ? std::string_view(answer.effect) : p.name;
      std::string one = size_words(key, p.value);
      if (one.empty()) one = key.ends_with("_N") ? value_text(p.value) + " N" : value_text(p.value);
      if (answer.parameters.size() > 1) one.insert(0, name_words(p.name) + " ");
      size += (size.empty() ? "" : ", ") + one;
    }
    part = fmt::format("{}, {:.0f} % sure", size.empty() ? part : fmt::format("{} ({})", part, size),
                       100 * answer.probability);
    if (!answer.ambiguous_with.empty())
      part += fmt::format(" ({} would look the same)", effect_words(answer.ambiguous_with.front()));
    parts.push_back(part);
  }
  const DiagnosisAnswer& first = diagnosis.answers.front();
  std::string out = fmt::format("{}", fmt::join(parts, ", and "));
  out.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(out.front())));
  if (first.effect.starts_with("parameter:")) out.front() = first.effect[10];  // a path stays as it is written
  return out + ".";
}

std::string value_text(double value) { return std::isfinite(value) ? fmt::format("{:.4g}", value) : "–"; }

std::string error_text(double error) { return std::isfinite(error) ? fmt::format("{:.2g}", error) : "–"; }

}  // namespace pneuservo
