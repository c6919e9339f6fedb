// What no single key of a reference can be checked for.
#include "config/reference_checks.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <pneuservo/elements/air.hpp>

#include "config/input_error.hpp"
#include "config/number_text.hpp"
#include "config/rig_parameters.hpp"

namespace pneuservo {

namespace {

/// A reference that goes on for ever is run this many of its (slowest) periods after its ramp.
constexpr double default_periods = 10.0;
/// Most positions among which the time of the farthest one is sought.
constexpr double most_samples = 1e6;

/// The reference itself; what it refuses becomes a sentence about the config.
Reference build_reference(const ReferenceSpec& spec, const ConfigNode& root) {
  try {
    return Reference(spec);
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", origin_of(root, "reference"), error.what()));
  }
}

bool oscillates(const ReferenceSpec& spec) {
  return spec.kind == ReferenceKind::sine || spec.kind == ReferenceKind::multisine;
}

/// How long an oscillation is run where the config does not say: from its start the ramp and ten periods.
double oscillation_end_s(const ReferenceSpec& spec) {
  double slowest_Hz = spec.kind == ReferenceKind::sine ? spec.frequency_Hz : infinite;
  for (const auto& component : spec.components) slowest_Hz = std::min(slowest_Hz, component[1]);
  const double ramp_s = spec.ramp_s < 0.0 ? 1.0 / slowest_Hz : spec.ramp_s;
  return spec.start_s + ramp_s + default_periods / slowest_Hz;
}

double highest_frequency_Hz(const ReferenceSpec& reference) {
  double highest = reference.kind == ReferenceKind::sine ? reference.frequency_Hz : 0.0;
  for (const auto& component : reference.components) highest = std::max(highest, component[1]);
  for (const ReferenceSpec& part : reference.parts) highest = std::max(highest, highest_frequency_Hz(part));
  return highest;
}

/// Speed at which the fully open valve lets air out of the smaller chamber: choked, whatever the pressure.
double fastest_mps(const Rig& rig) {
  const auto& axis = rig.axis;
  const Air<double> air(axis.air);
  return air.flow_constant * std::sqrt(air.R * air.temperature_K) * axis.valve.area_max_m2 /
         std::min(axis.cylinder.area_1_m2, axis.cylinder.area_2_m2);
}

/// Acceleration by the full supply on the larger area, nothing on the other side.
double hardest_mps2(const Rig& rig) {
  const auto& axis = rig.axis;
  return axis.supply.pressure_Pa * std::max(axis.cylinder.area_1_m2, axis.cylinder.area_2_m2) /
         (axis.slider.mass_kg + axis.slider.payload_kg);
}

}  // namespace

std::string stroke_key(const Rig& rig) { return rig.is_pneumatic() ? "cylinder.stroke_m" : "slider.stroke_m"; }

double default_duration_s(const ReferenceSpec& spec, const ConfigNode& root) {
  double end_s = 0.0;
  if (oscillates(spec)) return oscillation_end_s(spec);
  if (spec.kind != ReferenceKind::sum) return build_reference(spec, root).end_s() + 1.0;
  for (const ReferenceSpec& part : spec.parts) end_s = std::max(end_s, default_duration_s(part, root));
  return end_s;
}

void check_reference_range(const Rig& rig, const Check& check) {
  const double half_stroke = 0.5 * rig.axis.cylinder.stroke_m, nyquist = 0.5 / rig.period_s;
  if (const double highest = highest_frequency_Hz(rig.reference); highest > nyquist)
    check.refuse("reference", {"period_s"}, fmt::format("{} Hz", number_text(highest)),
                 fmt::format("at most half a cycle a control period ({} Hz)", number_text(nyquist)));
  if (needs_file(rig.reference)) return;  // its positions are known where recordings are read
  const Reference reference = build_reference(rig.reference, check.root);
  const ReferenceExtremes range = reference.extremes(0, rig.duration_s);
  const double worst_m = -range.minimum > range.maximum ? range.minimum : range.maximum;
  // Within rounding of the end stop is at the end stop.
  if (std::fabs(worst_m) <= half_stroke * (1.0 + 1e-12)) return;
  double worst_s = 0.0, nearest_m = infinite;
  const double samples = std::min(std::ceil(rig.duration_s / rig.period_s), most_samples);
  for (double k = 0; k <= samples; ++k) {
    const double t_s = rig.duration_s * k / samples, away_m = std::fabs(reference.at(t_s).d[0] - worst_m);
    if (away_m < nearest_m) nearest_m = away_m, worst_s = t_s;
  }
  check.refuse("reference", {stroke_key(rig), "duration_s", "reference.amplitude_m", "reference.center_m"},
               fmt::format("the position {:.6g} m at {:.6g} s", worst_m, worst_s),
               fmt::format("positions within +-half of {} ({} m)", stroke_key(rig), number_text(half_stroke)));
}

void check_reference_motion(const Rig& rig, const Check& check) {
  if (!rig.is_pneumatic() || needs_file(rig.reference)) return;
  const Reference reference = build_reference(rig.reference, check.root);
  const auto largest = [&](int order) {
    const ReferenceExtremes range = reference.extremes(order, rig.duration_s);
    return std::max(-range.minimum, range.maximum);
  };
  const double speed_mps = largest(1), acceleration_mps2 = largest(2);
  const std::vector<std::string> others{"valve.area_max_m2", "slider.mass_kg", "limits.speed_mps"};
  if (rig.limits.speed_mps && speed_mps > *rig.limits.speed_mps)
    check.refuse("reference", others, fmt::format("a speed of {:.4g} m/s", speed_mps),
                 fmt::format("at most limits.speed_mps ({} m/s)", number_text(*rig.limits.speed_mps)));
  if (speed_mps > fastest_mps(rig))
    check.refuse("reference", others, fmt::format("a speed of {:.4g} m/s", speed_mps),
                 fmt::format("at most {:.3g} m/s, at which the fully open valve empties the smaller chamber: give "
                             "the motion more time",
                             fastest_mps(rig)));
  if (acceleration_mps2 > hardest_mps2(rig))
    check.refuse("reference", others, fmt::format("an acceleration of {:.4g} m/s2", acceleration_mps2),
                 fmt::format("at most {:.3g} m/s2, which the full supply gives to the mass: give the motion more time",
                             hardest_mps2(rig)));
}

void check_reference_keys(const ReferenceSpec& reference, const ConfigNode& node, const std::string& path) {
  const auto key_origin = [&](const std::string& key) {
    const ConfigNode::Entry* entry = node.find(key);
    return entry != nullptr ? entry->value.origin : node.origin;
  };
  if (reference.kind == ReferenceKind::waypoints) {
    const std::size_t times = reference.times_s.size(), positions = reference.positions_m.size();
    if (times != positions)
      refuse(key_origin("positions_m"), join_path(path, "positions_m"), fmt::format("{} positions", positions),
             fmt::format("as many as times_s has ({})", times));
    for (std::size_t i = 1; i < times; ++i)
      if (!(reference.times_s[i] > reference.times_s[i - 1]))
        refuse(key_origin("times_s"), join_path(path, "times_s"),
               fmt::format("{} after {}", number_text(reference.times_s[i]), number_text(reference.times_s[i - 1])),
               "strictly increasing times");
  }
  if (reference.kind == ReferenceKind::cruise) {
    const double way_s = std::fabs(reference.end_m - reference.start_m) / reference.speed_mps;
    if (way_s < reference.ramp_s)
      refuse(key_origin("ramp_s"), join_path(path, "ramp_s"), number_text(reference.ramp_s),
             fmt::format("at most |end_m - start_m| / speed_mps ({:.6g} s), or the speed is never reached", way_s));
  }
  if (reference.kind == ReferenceKind::live) {
    if (path != "reference")
      refuse(key_origin("kind"), join_path(path, "kind"), "live as a part", "it as the whole reference");
    if (!(reference.lowest_m < reference.highest_m))
      refuse(key_origin("highest_m"), join_path(path, "highest_m"), number_text(reference.highest_m),
             fmt::format("more than lowest_m ({})", number_text(reference.lowest_m)));
  }
  if (reference.kind == ReferenceKind::file && !std::filesystem::exists(reference.path))
    refuse(key_origin("path"), join_path(path, "path"), fmt::format("no such file ({})", reference.path),
           "a file of positions");
  const ConfigNode::Entry* parts = node.find("parts");
  for (std::size_t i = 0; parts != nullptr && i < reference.parts.size(); ++i)
    check_reference_keys(reference.parts[i], parts->value.items[i], fmt::format("{}.parts.{}", path, i));
}

}  // namespace pneuservo
