// What the keys of a pressure rig leave open, and what no single one of them can say.
#include "config/pressure_checks.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>

#include <pneuservo/control/pulse_width.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/rig/pressure_axis.hpp>

#include "config/number_text.hpp"
#include "config/rig_parameters.hpp"

namespace pneuservo {
namespace {

constexpr double periods_of_a_sine = 10.0;

/// What it refuses becomes a sentence about the config.
PressureReference built_reference(const Rig& rig, const ConfigNode& root) {
  try {
    return PressureReference(rig.pressure_reference);
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", origin_of(root, "reference"), error.what()));
  }
}

/// Rate of the pressure p at the end of a hose without a drop, through the open valve between two pressures [Pa/s].
double rate_Pa_per_s(const Rig& rig, double up_Pa, double down_Pa, double p_Pa) {
  const auto& axis = rig.axis;
  const Air<double> air(axis.air);
  const double area_m2 = std::min(axis.valve.area_max_m2, axis.valve.area_per_volt_m2_per_V * axis.valve.command_max_V);
  const double b = axis.valve.critical_pressure_ratio, volume_m3 = rig.volume.volume_m3 + axis.line_1.volume_m3() +
                                                                   rig.volume.growth_m3(p_Pa, air.atmosphere_Pa);
  const double flow = area_m2 * orifice_flux(air, up_Pa, air.temperature_K, down_Pa, b);
  return flow * air.R * air.temperature_K / (volume_m3 + rig.volume.compliance_m3_per_Pa * p_Pa);
}

/// Commands that no machine of this config can follow must not be taken.
void check_live_rate(const Rig& rig, const Check& check) {
  const PressureReferenceParameters& live = rig.pressure_reference;
  if (live.kind != PressureReferenceKind::live) return;
  const double most = rig.controller.of<PressurePi>().rate_max_Pa_per_s;
  if (live.rate_Pa_per_s > most)
    check.refuse("reference.rate_Pa_per_s", {"controller.rate_max_Pa_per_s"}, number_text(live.rate_Pa_per_s),
                 fmt::format("at most controller.rate_max_Pa_per_s ({})", number_text(most)));
  const double fed = std::max(valve_fills_Pa_per_s(rig, live.lowest_Pa), valve_empties_Pa_per_s(rig, live.highest_Pa));
  if (live.rate_Pa_per_s > fed)
    check.refuse("reference.rate_Pa_per_s", {"valve", "volume"}, number_text(live.rate_Pa_per_s),
                 fmt::format("at most {:.3g}, which the open valve feeds at the best pressure of the range", fed));
}

/// What valve and hose can never give must not be asked for.
void check_pressure_reference(const Rig& rig, const Check& check) {
  const PressureReference reference = built_reference(rig, check.root);
  const ReferenceExtremes range = reference.range_Pa(rig.duration_s);
  const double lowest = rig.axis.air.atmosphere_Pa, highest = rig.axis.supply.pressure_Pa;
  if (range.minimum < lowest)
    check.refuse(
        "reference", {"air.atmosphere_Pa"}, fmt::format("a pressure of {}", number_text(range.minimum)),
        fmt::format("at least air.atmosphere_Pa ({}): the valve empties into the atmosphere", number_text(lowest)));
  if (range.maximum >= highest)
    check.refuse("reference", {"supply.pressure_Pa"}, fmt::format("a pressure of {}", number_text(range.maximum)),
                 fmt::format("less than supply.pressure_Pa ({})", number_text(highest)));
  if (rig.limits.pressure_Pa && range.maximum >= *rig.limits.pressure_Pa)
    check.refuse("limits.pressure_Pa", {"reference"}, number_text(*rig.limits.pressure_Pa),
                 fmt::format("more than the reference asks for ({})", number_text(range.maximum)));
}

/// A spool's physics has no place in a valve that is open or shut.
void check_effects_of_on_off(const Rig& rig, std::string_view section, const Check& check) {
  ValveEffects<double>::visit(
      [&](const Field& field, const auto& effect) {
        if (field.key == "valve_neutral_leak" || field.key == "valve_asymmetry") return;
        using Effect = std::remove_cvref_t<decltype(effect)>;
        bool acts = false;
        Effect::visit([&](const Field&, double value, double neutral) { acts |= value != neutral; }, effect,
                      static_cast<const Effect&>(Effect{}));
        if (acts)
          check.refuse(fmt::format("{}.{}", section, field.key), {"on_off_valves"}, "an effect of a spool",
                       "valve_neutral_leak or valve_asymmetry: on/off valves are open or shut, after their switching "
                       "times");
      },
      rig.axis.effects.valve);
}

void check_on_off_valves(const Rig& rig, const Check& check) {
  const auto& valve = *rig.axis.valve.on_off;
  const double periods = valve.carrier_period_s / rig.period_s;
  if (std::fabs(periods - std::round(periods)) > 1e-6 * periods)
    check.refuse("on_off_valves.carrier_period_s", {"period_s"}, number_text(valve.carrier_period_s),
                 fmt::format("a whole number of period_s ({})", number_text(rig.period_s)));
  const double least_s = PulseWidth::shortest_carrier_s(valve, rig.period_s);
  if (valve.carrier_period_s < least_s - 0.5 * rig.period_s)
    check.refuse("on_off_valves.carrier_period_s", {}, number_text(valve.carrier_period_s),
                 fmt::format("at least {}: a pulse longer than switching_time_on_s and a gap of switching_time_off_s",
                             number_text(least_s)));
  if (rig.axis.valve.natural_frequency_Hz > 0.0)
    check.refuse("valve.natural_frequency_Hz", {"on_off_valves"}, number_text(rig.axis.valve.natural_frequency_Hz),
                 "0 or nothing: on/off valves have switching times instead of a spool");
  if (rig.deviations.contains("valve.area_per_volt_m2_per_V"))
    check.refuse("deviations.valve.area_per_volt_m2_per_V", {"on_off_valves"}, "an area per volt",
                 "valve.area_max_m2: on/off valves are open or shut");
  if (rig.safe_output.command_V != 0.0)
    check.refuse("safe_output.command_V", {"on_off_valves"}, number_text(rig.safe_output.command_V),
                 "0 or nothing: both valves are shut without power");
}

/// The area per volt of valves that are open or shut follows from their area.
void check_area_of_on_off(const Rig& rig, const ConfigNode& root) {
  const auto& valve = rig.axis.valve;
  if (!valve.on_off || !(valve.command_max_V > 0.0)) return;
  const double follows = valve.area_max_m2 / valve.command_max_V;
  if (std::fabs(valve.area_per_volt_m2_per_V - follows) > 1e-6 * follows)
    refuse(origin_of(root, "valve"), "valve.area_per_volt_m2_per_V", number_text(valve.area_per_volt_m2_per_V),
           fmt::format("area_max_m2 over command_max_V ({}): on/off valves are open or shut", number_text(follows)));
}

}  // namespace

double valve_fills_Pa_per_s(const Rig& rig, double p_Pa) {
  return rate_Pa_per_s(rig, rig.axis.supply.pressure_Pa, p_Pa, p_Pa);
}

double valve_empties_Pa_per_s(const Rig& rig, double p_Pa) {
  const double atmosphere_Pa = rig.axis.air.atmosphere_Pa;
  return rate_Pa_per_s(rig, std::max(p_Pa, atmosphere_Pa), atmosphere_Pa, p_Pa);
}

void complete_pressure_rig(Rig& rig, const ConfigNode& root) {
  constexpr double settled_after_s = 2.0;
  const PressureReferenceParameters& reference = rig.pressure_reference;
  check_area_of_on_off(rig, root);
  if (!is_stated(root, "initial", "pressure_1_Pa")) rig.initial.pressure_1_Pa = rig.axis.air.atmosphere_Pa;
  if (root.find("duration_s") == nullptr) {
    const bool oscillates = reference.kind == PressureReferenceKind::sine;
    rig.duration_s = oscillates ? reference.start_s + (1.0 + periods_of_a_sine) / reference.frequency_Hz
                                : built_reference(rig, root).end_s() + settled_after_s;
  }
  lay_out_pressure_axis(rig);
}

void check_pressure_numbers(const Rig& rig, const Check& check) {
  check.of({"line_1"}, [&] {
    if (rig.axis.line_1.model != LineModel::distributed)
      check.refuse("line_1.model", {}, std::string(line_model_names[1]),
                   "distributed: the pressure at the far end is computed along the hose");
  });
  check.of({"supply", "air", "initial"}, [&] {
    if (rig.initial.pressure_1_Pa > rig.axis.supply.pressure_Pa)
      check.refuse("initial.pressure_1_Pa", {"supply.pressure_Pa"}, number_text(rig.initial.pressure_1_Pa),
                   fmt::format("at most supply.pressure_Pa ({})", number_text(rig.axis.supply.pressure_Pa)));
  });
  if (rig.axis.valve.on_off) {
    check.of({"on_off_valves", "period_s", "valve", "safe_output"}, [&] { check_on_off_valves(rig, check); });
    check.of({"on_off_valves", "effects"}, [&] { check_effects_of_on_off(rig, "effects", check); });
    if (!rig.concealed.empty())
      check.of({"on_off_valves", "effects", "concealed"},
               [&] { check_effects_of_on_off(simulated_rig(rig), "concealed", check); });
  }
  check.of({"reference", "air", "supply", "duration_s", "limits"}, [&] { check_pressure_reference(rig, check); });
  check.of({"reference", "air", "supply", "valve", "on_off_valves", "line_1", "volume", "controller"},
           [&] { check_live_rate(rig, check); });
  check.of({"serve"}, [&] {
    if (rig.serve && rig.serve->drive)
      check.refuse("serve.drive", {"rig"}, "a drive of a rig that controls a pressure",
                   "none: CiA 402 is of axes; commands come over the socket or serve.tcp_port");
  });
}

}  // namespace pneuservo
