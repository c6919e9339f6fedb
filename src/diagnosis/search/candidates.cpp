// All explanations that a diagnosis tries: effects of the vocabulary, parameters that are off, sensors at fault.
#include "diagnosis/search/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "config/rig_parameters.hpp"

namespace pneuservo {

namespace {

constexpr double tolerance_cut = 3;        ///< a parameter further off than this is an error, not a nuisance
constexpr double start_factor_cut = 6;
constexpr double wide_parameter_spread = 0.3;
constexpr double widest_z = 40;            ///< of an effect's size
constexpr double largest_load = 0.85;       ///< of the moving mass, on a soft coupling
constexpr double slowest_mps = 1e-5;       ///< top speed of a recording that stands
constexpr double free_convection = 25;      ///< W/(m2 K) between gas and wall, at most; on the faces of a cube
constexpr double difference_step = 0.01;   ///< of z, for what has a prior of its own

/// Numbers behind the scales of the vocabulary.
struct ScaleTable {
  const Rig& rig;
  const MotionRange& range;
  std::string channel;  ///< of a sensor effect

  /// A usual one where the config has none: recordings with pressures need no supply.
  double supply() const { return rig.axis.supply.pressure_Pa > 0 ? rig.axis.supply.pressure_Pa : 6e5; }
  double gauge_supply() const { return std::max(supply() - rig.axis.air.atmosphere_Pa, 1e4); }
  double force() const {
    return rig.kind == RigKind::driven_axis ? rig.drive.force_max_N : rig.axis.cylinder.area_1_m2 * gauge_supply();
  }
  double valve_area() const {
    if (rig.is_pneumatic()) return rig.axis.valve.area_max_m2;
    if (rig.kind == RigKind::switched_cylinder) return rig.throttle_1.inflow_area_m2;
    return 5e-3 * rig.vessel.volume_m3;  // empties the vessel within about a second, whatever its size
  }
  /// T (1 - (p_atm/p)^((kappa - 1)/kappa)), more than filling warms: T (kappa/(1 + (kappa - 1) p_atm/p) - 1). Gas that
  /// nothing has charged is as warm as its wall.
  double adiabatic_change() const {
    const AirParameters<double>& air = rig.axis.air;
    const double first_Pa = range.first_Pa > 0 ? range.first_Pa : air.atmosphere_Pa + gauge_supply();
    const double ratio = std::min(air.atmosphere_Pa / first_Pa, 1.0);
    return air.temperature_K * (1 - std::pow(ratio, 1 - 1 / air.heat_capacity_ratio));
  }
  double supply_resistance() const {
    const AirParameters<double>& air = rig.axis.air;
    return 10 * air.gas_constant_J_per_kgK * air.temperature_K / rig.vessel.volume_m3;
  }
  double moving_mass() const { return rig.axis.slider.mass_kg + rig.axis.slider.payload_kg; }
  double half_stroke() const { return 0.5 * rig.axis.cylinder.stroke_m; }
  double top_speed() const { return std::max(range.top_speed_mps, slowest_mps); }
  double channel_offset() const {
    if (channel == "x") return 2 * half_stroke();
    return channel == "F" ? force() : supply();
  }
  double operator()(EffectScale scale) const {
    switch (scale) {
      case EffectScale::one: return 1;
      case EffectScale::force: return force();
      case EffectScale::force_per_pressure: return force() / gauge_supply();
      case EffectScale::force_per_speed: return force() / top_speed();
      case EffectScale::drag: return force() / (top_speed() * top_speed());
      case EffectScale::stiffness: return force() / half_stroke();
      case EffectScale::valve_area: return valve_area();
      case EffectScale::inverse_valve_area: return 1 / (valve_area() * valve_area());
      case EffectScale::wall_heat: return free_convection * 6 * std::cbrt(std::pow(rig.vessel.volume_m3, 2));
      case EffectScale::laminar_conductance: {
        const Air<double> air(rig.axis.air);
        return air.flow_constant * valve_area() / (std::sqrt(air.R * air.temperature_K) * supply());
      }
      case EffectScale::moving_mass: return moving_mass();
      case EffectScale::top_speed: return top_speed();
      case EffectScale::half_stroke: return half_stroke();
      case EffectScale::channel_offset: return channel_offset();
      case EffectScale::viscosity: return rig.axis.slider.viscous_friction_Ns_per_m;
      case EffectScale::adiabatic_change: return adiabatic_change();
      case EffectScale::supply_resistance: return supply_resistance();
      case EffectScale::channel_gain: return channel == "x" || channel == "F" ? 1 : 0.6;
    }
    return 1;
  }
};

/// A parameter of an effect as a free one, with the start values of its grid [z].
struct GridParameter {
  FreeParameter free;
  std::vector<double> starts;
  double neutral, negligible;
  bool amplitude;
};

GridParameter grid_parameter(const ParameterTrait& trait, const Field& field, const std::string& path,
                             const ScaleTable& scales) {
  GridParameter out{{}, {}, get_parameter(scales.rig, path), 0, trait.grid.empty()};
  FreeParameter& free = out.free;
  free.path = path;
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
    // A rounding inside the range, but for a neutral value that stands at its end.
    const double inside = minimum < out.neutral ? 1e-9 : 0.0;
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

/// Fittings and bore of a valve's port: a volume right at the line's end.
constexpr LineBranch<double> port_volume{0, 0.01, 0.006, 0};

/// Narrows the bounds to what the parameter's field allows.
void keep_in_range(FreeParameter& free, const std::vector<ParameterPath>& known) {
  for (const ParameterPath& parameter : known)
    if (parameter.path == free.path) {
      free.lower = std::max(free.lower, free.z(parameter.field.minimum) + 1e-6);
      free.upper = std::min(free.upper, free.z(parameter.field.maximum) - 1e-6);
    }
}

/// `whole`, with the side of an effect's name: "chamber" and "chamber_leak_1" make "chamber_1".
std::string on_its_side(std::string_view whole, std::string_view name) {
  const bool has_side = name.ends_with("_1") || name.ends_with("_2");
  return std::string(whole) + std::string(has_side ? name.substr(name.size() - 2) : "");
}

/// Sizes of an amplitude whose whole change is looked at. The laws of a vessel are bent (heat that is none and heat
/// that keeps the gas at its wall's temperature empty it alike), and between nothing and their size lie other valleys.
std::span<const double> whole_sizes(const ParameterTrait& trait, const Rig& rig) {
  static constexpr std::array<double, 3> sizes{0.2, 0.6, 2.0};
  const bool is_looked_at = rig.kind == RigKind::vessel && trait.grid.empty() && trait.whole.empty();
  return is_looked_at ? std::span<const double>(sizes) : trait.whole;
}

/// The effect as a candidate: every combination of its grids is a start.
template <class Effect>
Candidate effect_candidate(const std::string& name, const std::string& element, const std::string& family,
                           CandidateKind kind, const ScaleTable& scales) {
  Candidate candidate{name, element, kind, {}, {}, {}, {{}}, {}, {}, family};
  if constexpr (requires { Effect::is_mimicked_by_small_physics; })
    candidate.is_mimicked_by_small_physics = Effect::is_mimicked_by_small_physics;
  if constexpr (requires { Effect::is_description; })
    candidate.is_description = candidate.is_never_added = Effect::is_description;
  if constexpr (requires { Effect::shown_by; }) candidate.shown_by = Effect::shown_by;
  if constexpr (requires { Effect::extra; }) candidate.extra = fmt::format("effects.{}.{}", name, Effect::extra);
  if constexpr (requires { Effect::is_never_added; }) candidate.is_never_added = Effect::is_never_added;
  const Effect none;
  for (const ParameterTrait& trait : Effect::traits) {
    Effect::visit(
        [&](const Field& field, const auto&) {
          if (field.key != trait.key) return;
          const GridParameter made =
              grid_parameter(trait, field, fmt::format("effects.{}.{}", name, field.key), scales);
          candidate.parameters.push_back(made.free);
          candidate.negligible.push_back(made.negligible);
          candidate.neutral.push_back(made.neutral);
          candidate.amplitude.push_back(made.amplitude);
          std::vector<std::vector<double>> starts;
          for (const std::vector<double>& start : candidate.starts)
            for (const double z : made.starts) {
              starts.push_back(start);
              starts.back().push_back(z);
            }
          candidate.starts = starts;
        },
        none);
  }
  for (std::size_t p = 0; p < Effect::traits.size(); ++p)
    for (const double z : whole_sizes(Effect::traits[p], scales.rig))
      for (std::vector<double> start : candidate.starts) {
        start[p] = z;
        candidate.whole_starts.push_back(start);
      }
  return candidate;
}

void add_effects(const Rig& rig, const MotionRange& range, std::vector<Candidate>& out) {
  const ScaleTable scales{rig, range, ""};
  const std::vector<FreeParameter> known = nuisances(rig, 0, 0);
  visit_effects(rig, [&](const Field& field, const auto& effect) {
    using Effect = std::remove_cvref_t<decltype(effect)>;
    if constexpr (requires { Effect::is_always_granted; } || requires { Effect::is_sought_apart; }) return;
    if constexpr (requires { Effect::is_of_plain_axes; })
      if (rig.kind != RigKind::driven_axis || rig.has_pistons()) return;
    if constexpr (requires { Effect::same_as; })
      if (std::any_of(known.begin(), known.end(), [](const FreeParameter& p) { return p.path == Effect::same_as; }))
        return;
    // An effect that the owner knows is not missing: what may be wrong is its size, as of any other parameter.
    const std::string own = fmt::format("effects.{}.", field.key);
    if (std::any_of(known.begin(), known.end(), [&](const FreeParameter& p) { return p.path.starts_with(own); }))
      return;
    Candidate candidate =
        effect_candidate<Effect>(std::string(field.key), on_its_side(Effect::element, field.key),
                                 on_its_side(Effect::family, field.key), CandidateKind::effect, scales);
    const bool has_range = std::all_of(candidate.parameters.begin(), candidate.parameters.end(),
                                       [](const FreeParameter& p) { return p.lower < p.upper; });
    if (has_range) out.push_back(std::move(candidate));  // else physics leaves it no size here
  });
}

/// The size of an effect at a path, as of one that no owner knows.
struct EffectSize {
  double spread = 0;  ///< prior, in what is varied; 0: the path is none of an effect's sizes
  std::string family;
};
EffectSize effect_size(const std::string& path, const ScaleTable& scales) {
  EffectSize out;
  visit_effects(scales.rig, [&](const Field& field, const auto& effect) {
    using Effect = std::remove_cvref_t<decltype(effect)>;
    for (const ParameterTrait& trait : Effect::traits)
      if (path == fmt::format("effects.{}.{}", field.key, trait.key) && trait.variation == Variation::linear &&
          trait.grid.empty())
        out = {trait.spread * scales(trait.scale), on_its_side(Effect::family, field.key)};
  });
  return out;
}

/// A parameter that is off: a number that is read off by a tenth to eleven times itself, the size of an effect that the
/// owner has guessed by as much as that of one that he does not know.
Candidate parameter_candidate(const FreeParameter& known, const ScaleTable& scales) {
  Candidate candidate;
  candidate.name = "parameter:" + known.path;
  candidate.element = element_of_path(known.path);
  candidate.kind = CandidateKind::parameter;
  const EffectSize size = effect_size(known.path, scales);
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
          using Effect = std::remove_cvref_t<decltype(effect)>;
          // Offset, gain and lag of one sensor mimic each other.
          out.push_back(effect_candidate<Effect>(fmt::format("{}:{}", field.key, name), "sensor:" + name, ":" + name,
                                                 CandidateKind::sensor, scales));
        },
        none);
  }
}

}  // namespace

MotionRange motion_range(const std::vector<ResidualRow>& rows) {
  MotionRange range{1e300, -1e300, 0};
  for (const ResidualRow& row : rows) {
    range.lowest_m = std::min(range.lowest_m, row.position_m);
    range.highest_m = std::max(range.highest_m, row.position_m);
    range.top_speed_mps = std::max(range.top_speed_mps, std::abs(row.velocity_mps));
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
    const std::size_t colon = name.find(':');
    if (colon != std::string::npos) return "sensor:" + name.substr(colon + 1);
    std::string element = "motion";
    const AxisEffects<double> none;
    const auto take = [&](const Field& field, const auto& effect) {
      using Effect = std::remove_cvref_t<decltype(effect)>;
      if (field.key == name) element = on_its_side(Effect::element, field.key);
    };
    AxisEffects<double>::visit(take, none);
    const VesselEffects<double> vessel;
    VesselEffects<double>::visit(take, vessel);
    return element;
  }
  return "motion";
}

std::vector<FreeParameter> nuisances(const Rig& rig, std::size_t start_factor_count, double start_factor_sigma) {
  std::vector<FreeParameter> out;
  const std::vector<ParameterPath> known = parameter_paths(rig);
  for (const auto& [path, tolerance] : rig.tolerances) {
    const double value = get_parameter(rig, path);
    if (value == 0 || tolerance <= 0) continue;  // nothing to vary
    FreeParameter free;
    free.path = path;
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

SmallPhysics small_physics(Rig rig, const std::vector<ResidualChannel>& channels) {
  std::vector<FreeParameter> out;
  const std::vector<ParameterPath> known = parameter_paths(rig);
  const auto add = [&](const std::string& path, double spread, double step = difference_step) {
    if (!has_parameter(rig, path) || rig.tolerances.count(path) > 0) return;
    FreeParameter free;
    free.path = path;
    free.center = get_parameter(rig, path);
    free.spread = spread;
    free.lower = -tolerance_cut;
    free.upper = tolerance_cut;
    free.step = step;
    keep_in_range(free, known);
    free.lower = std::min(free.lower, 0.0);
    out.push_back(free);
  };
  if (!rig.is_pneumatic()) return {std::move(rig), {}};
  constexpr double overlap_V = 0.02, overlap_step = 0.2;  // a step of 4 mV: more than the command dithers at rest
  constexpr double edge_share = 0.02, delay_s = 3e-4, zero_Pa = 200, lag_s = 3e-4, port_volume_m3 = 5e-6;
  const std::size_t before = out.size();
  add("effects.valve_dead_band.width_V", overlap_V, overlap_step);
  if (out.size() > before) {  // overlap or underlap: the law of the edges is one, whatever the sign
    out.back().signed_overlap = true;
    out.back().lower = -tolerance_cut;
  }
  add("effects.valve_asymmetry.exhaust_ratio", edge_share);
  add("effects.valve_curve.near_middle", 2 * edge_share);
  add("effects.valve_curve.wide_open", 2 * edge_share);
  add("effects.command_delay.delay_s", delay_s);
  add("effects.frequency_dependent_losses.share", 1);
  for (const auto& [name, branch] : {std::pair{"line_branch_1", &rig.axis.effects.line_branch_1},
                                     std::pair{"line_branch_2", &rig.axis.effects.line_branch_2}}) {
    if (branch->volume_m3 == 0) *branch = port_volume;
    add(fmt::format("effects.{}.volume_m3", name), port_volume_m3);
  }
  for (const ResidualChannel& channel : channels) {
    if (!channel.name.starts_with("p")) continue;
    add(fmt::format("effects.sensor_offset:{}.offset", channel.name), zero_Pa);
    add(fmt::format("effects.sensor_lag:{}.time_constant_s", channel.name), lag_s);
  }
  return {std::move(rig), std::move(out)};
}

Rig without_empty_port_volumes(Rig rig) {
  for (LineBranch<double>* branch : {&rig.axis.effects.line_branch_1, &rig.axis.effects.line_branch_2})
    if (branch->volume_m3 == 0) *branch = {};
  return rig;
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
