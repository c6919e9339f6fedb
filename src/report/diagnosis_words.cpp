// What a diagnosis says, in a machine builder's words: effects, elements, sizes.
#include <report/diagnosis_words.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "elements/effect_entry.hpp"

namespace pneuservo {
namespace {

std::string with_side(std::string_view words, std::string_view side) {
  std::string out;
  for (const char c : words)
    if (c == '#') out += side;
    else out += c;
  return out;
}

struct SizeUnit {
  std::string_view ending, unit;
  double factor;
};
constexpr SizeUnit size_units[] = {{"_m2", "mm²", 1e6},   {"_m3", "cm³", 1e6}, {"_kPa", "kPa", 1}, {"_Pa", "kPa", 1e-3},
                                   {"_mps", "mm/s", 1e3}, {"_m", "mm", 1e3},   {"_V", "mV", 1e3},  {"_kg", "kg", 1},
                                   {"_Hz", "Hz", 1},      {"_s", "ms", 1e3}};

/// "coulomb force" for coulomb_force_N: the key without its unit.
std::string name_words(std::string_view key) {
  std::string words(key.substr(0, key.find_last_of('_')));
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

}  // namespace

std::string effect_words(std::string_view effect) {
  if (effect.starts_with("parameter:")) return fmt::format("{} is not what the config says", effect.substr(10));
  if (effect == "unknown") return "something that no name explains";
  const EffectEntry* entry = find_effect(effect);
  if (entry != nullptr) return with_side(entry->words, split_effect(effect).side);
  return std::string(effect);
}

std::string size_words(std::string_view key, double value) {
  if (!std::isfinite(value) || key.find("_per_") != std::string_view::npos) return "";
  for (const SizeUnit& handy : size_units) {
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

std::string error_text(double error) { return std::isfinite(error) ? fmt::format("{:.2g}", error) : "–"; }

}  // namespace pneuservo
