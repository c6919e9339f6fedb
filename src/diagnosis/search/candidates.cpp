// All explanations that a diagnosis tries: effects of the vocabulary, parameters that are off, sensors at fault.
#include "diagnosis/search/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "config/effects_reader.hpp"
#include "config/rig_parameters.hpp"
#include "config/section_reader.hpp"
#include "diagnosis/residuals/command_answer.hpp"

namespace pneuservo {

namespace {

constexpr double tolerance_cut = 3;        ///< a parameter further off than this is an error, not a nuisance
constexpr double start_factor_cut = 6;
constexpr double wide_parameter_spread = 0.3;
constexpr double widest_z = 40;            ///< of an effect's size
constexpr double largest_load = 0.85;       ///< of the moving mass, on a soft coupling
constexpr double difference_step = 0.01;   ///< of z, for what has a prior of its own

/// A parameter of an effect as a free one, with the start values of its grid [z].
struct GridParameter {
  FreeParameter free;
  std::vector<double> starts;
  double neutral, negligible;
  bool amplitude;
};

GridParameter grid_parameter(const ParameterTrait& trait, const Field& field, const std::string& path,
                             const ScaleTable& scales) {
  GridParameter out{free_number(scales.rig, path), {}, 0, 0, trait.grid.empty()};
  FreeParameter& free = out.free;
  out.neutral = free.value_in(scales.rig);
  free.variation = trait.variation;
  const double scale = scales(trait.scale);
  // A vessel that is watched for minutes shows far smaller leaks than an axis that moves.
  const double watched = scales.rig.kind == RigKind::vessel ? 0.05 : 1.0;
  out.negligible = watched * trait.negligible * scale;
  if (out.amplitude) {
    free.center = free.varied(out.neutral);
    free.spread = trait.spread * scale;
    out.starts = {0.0};
  } else {
    const double middle = trait.is_over_motion ? 0.5 * (scales.range.lowest_m + scales.range.highest_m) : 0.0;
    const double reach = trait.is_over_motion ? 0.5 * (scales.range.highest_m - scales.range.lowest_m) + 1e-4 : scale;
    for (const double value : trait.grid)
      free.center += free.varied(middle + reach * value) / double(trait.grid.size());
    free.spread = trait.variation == Variation::logarithmic ? trait.spread : trait.spread * reach;
    for (const double value : trait.grid) out.starts.push_back(free.z(middle + reach * value));
    free.step = difference_step;
  }
  // Bounds: the field's range, the physical one, and not beyond what a prior of this width can mean.
  free.lower = -widest_z;
  free.upper = widest_z;
  const double over = scales(trait.range_scale);
  const double minimum = std::isfinite(trait.least) ? std::max(field.minimum, trait.least * over) : field.minimum,
               maximum = std::isfinite(trait.most) ? std::min(field.maximum, trait.most * over) : field.maximum;
  if (trait.variation == Variation::linear) {
    // A rounding inside the range, but where the prior's centre stands at its end: that value is exact.
    const double inside = minimum < free.center ? 1e-9 : 0.0;
    free.lower = std::max(free.lower, free.z(minimum) + inside);
    free.upper = std::min(free.upper, free.z(maximum) - 1e-9);
    // Something of the moving mass stays on the slider.
    if (trait.scale == EffectScale::moving_mass) free.upper = std::min(free.upper, free.z(largest_load * scale));
  } else if (trait.variation == Variation::inverse_square) {
    free.lower = 0;
  } else {
    // Not far beyond the grid: there the effect is another one, or nothing that these data show.
    const auto [least, most] = std::minmax_element(out.starts.begin(), out.starts.end());
    free.lower = *least - std::log(2.0) / free.spread;
    free.upper = *most + std::log(4.0) / free.spread;
    if (field.minimum > 0) free.lower = std::max(free.lower, free.z(field.minimum) + 1e-9);
    if (field.maximum < infinite) free.upper = std::min(free.upper, free.z(field.maximum) - 1e-9);
    // A motion that is too slow or too fast for the field starts at its end.
    for (double& start : out.starts) start = std::max(std::min(start, free.upper), free.lower);
  }
  return out;
}

/// Narrows the bounds to what the parameter's field allows.
void keep_in_range(FreeParameter& free, const std::vector<ParameterPath>& known) {
  for (const ParameterPath& parameter : known)
    if (parameter.path == free.path) {
      free.lower = std::max(free.lower, free.z(parameter.field.minimum) + 1e-6);
      free.upper = std::min(free.upper, free.z(parameter.field.maximum) - 1e-6);
    }
}

/// Sizes of an amplitude whose whole change is looked at. The laws of a vessel are bent (heat that is none and heat
/// that keeps the gas at its wall's temperature empty it alike), and between nothing and their size lie other valleys.
std::vector<double> whole_sizes(const ParameterTrait& trait, const Rig& rig) {
  const bool is_looked_at = rig.kind == RigKind::vessel && trait.grid.empty() && trait.whole.empty();
  if (is_looked_at) return {0.2, 0.6, 2.0};
  std::vector<double> out(trait.whole.begin(), trait.whole.end());
  // As far as the answer to the command is compared.
  if (trait.has_valleys)
    for (std::size_t periods = 1; periods <= CommandAnswer::latest; ++periods)
      out.push_back(static_cast<double>(periods) * rig.period_s / trait.spread);
  return out;
}

/// Every combination of a parameter's starts with those of the parameters before it.
std::vector<std::vector<double>> combined(const std::vector<std::vector<double>>& before,
                                          const std::vector<double>& own) {
  std::vector<std::vector<double>> out;
  for (const std::vector<double>& start : before)
    for (const double z : own) {
      out.push_back(start);
      out.back().push_back(z);
    }
  return out;
}

/// The effect as a candidate: every combination of its grids is a start.
Candidate effect_candidate(const std::string& name, const EffectEntry& entry, const std::vector<Field>& fields,
                           const ScaleTable& scales) {
  Candidate candidate;
  candidate.name = name;
  candidate.element = on_side_of(entry.element, name);
  candidate.kind = split_effect(name).is_of_sensor ? CandidateKind::sensor : CandidateKind::effect;
  candidate.starts = {{}};
  candidate.family = on_side_of(entry.family, name);
  candidate.entry = &entry;
  candidate.is_description = entry.role == EffectRole::description;
  candidate.is_never_added = entry.is_never_added || candidate.is_description;
  candidate.shown_by = entry.shown_by;
  for (const ParameterTrait& trait : entry.parameters) {
    const auto field = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.key == trait.key; });
    const GridParameter made = grid_parameter(trait, *field, candidate.path_of(trait.key), scales);
    candidate.parameters.push_back(made.free);
    candidate.negligible.push_back(made.negligible);
    candidate.neutral.push_back(made.neutral);
    candidate.amplitude.push_back(made.amplitude);
    candidate.starts = combined(candidate.starts, made.starts);
  }
  for (std::size_t p = 0; p < entry.parameters.size(); ++p)
    for (const double z : whole_sizes(entry.parameters[p], scales.rig))
      for (std::vector<double> start : candidate.starts) {
        start[p] = z;
        candidate.whole_starts.push_back(start);
      }
  return candidate;
}

/// Whether a diagnosis of this rig looks for the effect by name.
bool is_looked_for(const std::string& name, const EffectEntry& entry, const Rig& rig,
                   const std::vector<FreeParameter>& known) {
  if (entry.role != EffectRole::law && entry.role != EffectRole::description) return false;
  if (entry.is_of_plain_axes && (rig.kind != RigKind::driven_axis || rig.has_pistons())) return false;
  // An effect that the owner knows is not missing: what may be wrong is its size, as of any other parameter.
  const std::string own = fmt::format("effects.{}.", name);
  return std::none_of(known.begin(), known.end(), [&](const FreeParameter& p) {
    return p.path.starts_with(own) || (!entry.same_as.empty() && p.path == entry.same_as);
  });
}

void add_effects(const Rig& rig, const MotionRange& range, std::vector<Candidate>& out) {
  const ScaleTable scales{rig, range};
  const std::vector<FreeParameter> known = nuisances(rig, 0, 0);
  visit_effects(rig, [&](const Field& field, const auto& effect) {
    const std::string name(field.key);
    const EffectEntry& entry = *find_effect(name);
    if (!is_looked_for(name, entry, rig, known)) return;
    Candidate candidate = effect_candidate(name, entry, fields_of(effect), scales);
    const bool has_range = std::all_of(candidate.parameters.begin(), candidate.parameters.end(),
                                       [](const FreeParameter& p) { return p.lower < p.upper; });
    if (has_range) out.push_back(std::move(candidate));  // else physics leaves it no size here
  });
}

/// The size of an effect at a path, as of one that no owner knows.
struct UnknownSize {
  double spread = 0;  ///< prior, in what is varied; 0: the path is none of an effect's sizes
  std::string family;
};
UnknownSize unknown_size(const std::string& path, const ScaleTable& scales) {
  if (!path.starts_with("effects.")) return {};
  const std::string name = path.substr(8, path.rfind('.') - 8);
  const ParameterTrait* trait = trait_of(path);
  if (trait == nullptr || split_effect(name).is_of_sensor) return {};
  if (trait->variation != Variation::linear || !trait->grid.empty()) return {};
  return {trait->spread * scales(trait->scale), on_side_of(find_effect(name)->family, name)};
}

/// A parameter that is off: a number that is read off by a tenth to eleven times itself, the size of an effect that the
/// owner has guessed by as much as that of one that he does not know.
Candidate parameter_candidate(const FreeParameter& known, const ScaleTable& scales) {
  Candidate candidate;
  candidate.name = "parameter:" + known.path;
  candidate.element = element_of_path(known.path);
  candidate.kind = CandidateKind::parameter;
  const UnknownSize size = unknown_size(known.path, scales);
  candidate.is_guessed = size.spread > 0;
  candidate.family = candidate.is_guessed ? size.family : candidate.name;
  FreeParameter free = known;
  const double magnitude = std::abs(known.center);
  free.spread = std::max(wide_parameter_spread * magnitude, size.spread);
  free.lower = candidate.is_guessed ? -widest_z : (known.center < 0 ? -10 : -0.9) * magnitude / free.spread;
  free.upper = candidate.is_guessed ? widest_z : (known.center < 0 ? 0.9 : 10) * magnitude / free.spread;
  keep_in_range(free, parameter_paths(scales.rig));
  free.step = known.step * known.spread / free.spread;
  candidate.parameters = {free};
  candidate.negligible = {0.0};
  candidate.neutral = {free.center};
  candidate.starts = {{0.0}};
  candidate.amplitude = {1};
  return candidate;
}

void add_sensors(const Rig& rig, const MotionRange& range, const std::vector<ResidualChannel>& channels,
                 std::vector<Candidate>& out) {
  for (const Signal signal : all_signals) {
    const std::string name(info(signal).name);
    const bool compared = std::any_of(channels.begin(), channels.end(),
                                      [&](const ResidualChannel& c) { return c.name == name && !c.is_balance; });
    const bool moves = signal == Signal::x && rig.kind != RigKind::vessel;
    const bool acts = is_chamber(signal) && rig.kind == RigKind::driven_axis;  // in the force balance
    if (!moves && !((compared || acts) && has_parameter(rig, fmt::format("effects.sensor_offset:{}.offset", name))))
      continue;
    const ScaleTable scales{rig, range, name};
    const SensorEffects<double> none;
    SensorEffects<double>::visit(
        [&](const Field& field, const auto& effect) {
          out.push_back(effect_candidate(fmt::format("{}:{}", field.key, name), *find_effect(field.key),
                                         fields_of(effect), scales));
        },
        none);
  }
}

}  // namespace

MotionRange motion_range(const std::vector<ResidualRow>& rows) {
  MotionRange range{.lowest_m = 1e300, .highest_m = -1e300};
  std::map<int, double> begins_s;  // by recording: each has a clock of its own
  for (const ResidualRow& row : rows) {
    double& begin_s = begins_s.try_emplace(row.recording, row.time_s).first->second;
    begin_s = std::min(begin_s, row.time_s);
  }
  for (const ResidualRow& row : rows) {
    range.lowest_m = std::min(range.lowest_m, row.position_m);
    range.highest_m = std::max(range.highest_m, row.position_m);
    range.top_speed_mps = std::max(range.top_speed_mps, std::abs(row.velocity_mps));
    range.duration_s = std::max(range.duration_s, row.time_s - begins_s[row.recording]);
  }
  if (rows.empty()) range.lowest_m = range.highest_m = 0;
  return range;
}

std::string element_of_path(const std::string& path) {
  std::string section = path.substr(0, path.find('.'));
  if (section == "slider") return "motion";
  if (section == "line_1" || section == "line_2" || section == "valve" || section == "supply") return section;
  if (section.starts_with("throttle_") || section.starts_with("cushion_")) return section;
  if (section == "air") return "supply";
  if (section == "vessel") return "chamber_1";
  if (section == "line") return "line_1";
  if (section == "cylinder") {
    if (path.find("_2") != std::string::npos && path.find("_m2") == std::string::npos) return "chamber_2";
    if (path.starts_with("cylinder.area_2")) return "chamber_2";
    return "chamber_1";
  }
  if (section == "effects") {  // the effect's own element
    const std::string name = path.substr(8, path.rfind('.') - 8);
    const EffectEntry* entry = find_effect(name);
    return entry == nullptr ? "motion" : on_side_of(entry->element, name);
  }
  return "motion";
}

std::vector<FreeParameter> nuisances(const Rig& rig, std::size_t start_factor_count, double start_factor_sigma) {
  std::vector<FreeParameter> out;
  const std::vector<ParameterPath> known = parameter_paths(rig);
  for (const auto& [path, tolerance] : rig.tolerances) {
    FreeParameter free = free_number(rig, path);
    const double value = free.value_in(rig);
    if (value == 0 || tolerance <= 0) continue;  // nothing to vary
    free.center = value;
    free.spread = tolerance * std::abs(value);
    free.lower = -tolerance_cut;
    free.upper = tolerance_cut;
    free.step = difference_step;
    keep_in_range(free, known);
    out.push_back(free);
  }
  for (std::size_t i = 0; i < start_factor_count; ++i) {
    FreeParameter free;
    free.start_factor = static_cast<int>(i);
    free.spread = start_factor_sigma;
    free.lower = -start_factor_cut;
    free.upper = start_factor_cut;
    free.step = difference_step;
    out.push_back(free);
  }
  return out;
}

std::vector<FreeParameter> table_values(const Rig& rig, const std::string& effect, const MotionRange& range) {
  std::vector<FreeParameter> out;
  const ScaleTable scales{rig, range};
  visit_effects(rig, [&](const Field& field, const auto& table) {
    if (field.key == effect) out = effect_candidate(effect, *find_effect(effect), fields_of(table), scales).parameters;
  });
  return out;
}

namespace {

/// The names of an effect that the rig has: one, one a side, one a channel.
std::vector<std::string> names_of(const EffectEntry& entry, const std::vector<std::string>& all) {
  std::vector<std::string> out;
  std::copy_if(all.begin(), all.end(), std::back_inserter(out),
               [&](const std::string& name) { return split_effect(name).base == entry.name; });
  return out;
}

/// Adds the small sizes of one effect about what the rig has of it.
void add_small(const Rig& rig, const std::string& name, const EffectEntry& entry,
               const std::vector<ParameterPath>& known, std::vector<FreeParameter>& out) {
  const MotionRange at_rest{};
  const ScaleTable scales{rig, at_rest, {}, split_effect(name).side == "2" ? 2 : 1};
  for (const ParameterTrait& trait : entry.parameters) {
    const std::string path = fmt::format("effects.{}.{}", name, trait.key);
    if (trait.small_spread == 0 || rig.tolerances.count(path) > 0) continue;
    FreeParameter free = free_number(rig, path);
    free.variation = trait.variation;
    free.center = free.varied(free.value_in(rig));
    free.spread = trait.small_spread * scales(trait.small_scale);
    free.lower = -tolerance_cut;
    free.upper = tolerance_cut;
    free.step = trait.small_step;
    if (trait.variation == Variation::inverse_square) free.lower = std::max(free.lower, -free.center / free.spread);
    else keep_in_range(free, known);
    free.lower = std::min(free.lower, 0.0);
    out.push_back(free);
  }
}

}  // namespace

bool is_granted(const Candidate& candidate) {
  if (candidate.entry == nullptr) return false;
  const auto& parameters = candidate.entry->parameters;
  if (candidate.is_description && std::all_of(parameters.begin(), parameters.end(),
                                              [](const ParameterTrait& trait) { return trait.small_spread > 0; }))
    return true;
  return std::any_of(all_effects().begin(), all_effects().end(), [&](const EffectEntry* other) {
    return other->role == EffectRole::granted && other->family == candidate.entry->family;
  });
}

bool stands_for(const FreeParameter& granted, const Candidate& candidate) {
  const std::string_view path = granted.path, head = "effects.";
  const std::vector<FreeParameter>& own = candidate.parameters;
  if (std::any_of(own.begin(), own.end(), [&](const FreeParameter& p) { return p.path == path; })) return true;
  if (!path.starts_with(head)) return false;
  const EffectEntry* entry = find_effect(path.substr(head.size(), path.rfind('.') - head.size()));
  return entry != nullptr &&
         std::any_of(entry->stands_for.begin(), entry->stands_for.end(), [&](std::string_view other) {
           return candidate.entry != nullptr ? other == candidate.entry->name : other == candidate.parameters[0].path;
         });
}

std::vector<FreeParameter> small_physics(const Rig& rig, const std::vector<ResidualChannel>& channels,
                                         const std::vector<std::string>& left_out) {
  std::vector<FreeParameter> out;
  if (!rig.is_pneumatic()) return out;
  const std::vector<ParameterPath> known = parameter_paths(rig);
  const std::vector<std::string> names = effect_names(rig);
  for (const EffectEntry* entry : all_effects())
    for (const std::string& name : names_of(*entry, names)) {
      if (!split_effect(name).is_of_sensor) add_small(rig, name, *entry, known, out);
    }
  for (const ResidualChannel& channel : channels) {
    if (!channel.name.starts_with("p")) continue;
    for (const EffectEntry* entry : all_effects()) {
      const std::string name = fmt::format("{}:{}", entry->name, channel.name);
      if (std::find(names.begin(), names.end(), name) != names.end()) add_small(rig, name, *entry, known, out);
    }
  }
  std::erase_if(out, [&](const FreeParameter& granted) {
    return std::any_of(left_out.begin(), left_out.end(), [&](const std::string& name) {
      return granted.path.starts_with(fmt::format("effects.{}.", name));
    });
  });
  return out;
}

std::vector<Candidate> all_candidates(const Rig& rig, const std::vector<ResidualChannel>& channels,
                                      const MotionRange& range) {
  std::vector<Candidate> out;
  add_effects(rig, range, out);
  for (const FreeParameter& known : nuisances(rig, 0, 0))
    out.push_back(parameter_candidate(known, ScaleTable{rig, range, ""}));
  add_sensors(rig, range, channels, out);
  return out;
}

}  // namespace pneuservo
