// What a wrong key was meant to be: the nearest known name, or the known name with another unit.
#include "config/key_suggestion.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "config/units.hpp"

namespace pneuservo {

int edit_distance(std::string_view a, std::string_view b) {
  // Optimal string alignment on three rows.
  std::vector<int> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

std::vector<std::string> near_names(std::string_view wrong, const std::vector<std::string>& known) {
  std::vector<std::pair<int, std::string>> near;
  for (const std::string& name : known) {
    const bool contained = name.find(wrong) != std::string::npos || wrong.find(name) != std::string::npos;
    const bool part = wrong.size() >= 4 && contained;
    const int distance = edit_distance(wrong, name);
    const int reach = std::max(1, static_cast<int>(std::max(wrong.size(), name.size())) / 3);
    if (distance <= reach || part) near.emplace_back(distance, name);
  }
  std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, near.size()); ++i) names.push_back(near[i].second);
  return names;
}

std::string unit_suffix(std::string_view unit) {
  if (unit.empty() || unit == "-" || unit == "SI") return "";
  if (unit == "m/s") return "_mps";
  if (unit == "m/s2") return "_mps2";
  if (unit == "kg/s") return "_kgps";
  if (unit == "V/(m s)") return "_V_per_m_s";
  std::string suffix = "_";
  for (const char c : unit) {
    if (c == '/') suffix += suffix.back() == '_' ? "per_" : "_per_";
    else if (c == '1' && suffix == "_") continue;
    else if (c != ' ' && c != '(' && c != ')') suffix += c;
  }
  return suffix;
}

const Field* field_of_other_unit(std::string_view wrong, std::span<const Field> fields) {
  const Field* best = nullptr;
  std::size_t longest = 0;
  for (const Field& field : fields) {
    const std::string suffix = unit_suffix(field.unit);
    if (suffix.empty() || !field.key.ends_with(suffix) || wrong == field.key) continue;
    const std::string_view stem = field.key.substr(0, field.key.size() - suffix.size());
    const bool same_quantity = wrong == stem || (wrong.starts_with(stem) && wrong[stem.size()] == '_');
    if (same_quantity && stem.size() > longest) best = &field, longest = stem.size();
  }
  return best;
}

std::string expected_names(std::string_view wrong, const std::vector<std::string>& known) {
  const std::vector<std::string> near = near_names(wrong, known);
  if (near.empty()) return fmt::format("one of {}", fmt::join(known, ", "));
  return fmt::format("a known one (did you mean {}?)", fmt::join(near, ", "));
}

std::string expected_keys(std::string_view wrong, std::span<const Field> fields) {
  std::vector<std::string> known;
  for (const Field& field : fields) known.emplace_back(field.key);
  const Field* other = field_of_other_unit(wrong, fields);
  if (other == nullptr) return expected_names(wrong, known);
  // A slip of one letter is likelier meant as another key than as another unit (pressure_1_Pa, pressure_2_Pa).
  for (const std::string& name : near_names(wrong, known))
    if (name != other->key && edit_distance(wrong, name) < edit_distance(wrong, other->key))
      return expected_names(wrong, known);
  const std::string_view stem = key_without_unit(*other);
  if (stem.empty() || wrong == stem) return fmt::format("the key {} (in {})", other->key, other->unit);
  return fmt::format("the key {} (in {}), or {} with its unit", other->key, other->unit, stem);
}

}  // namespace pneuservo
