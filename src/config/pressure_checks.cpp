// What the keys of a pressure rig leave open, and what no single one of them can say.
#include "config/pressure_checks.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include <pneuservo/rig/pressure_axis.hpp>

#include "config/number_text.hpp"

namespace pneuservo {
namespace {

constexpr double periods_of_a_sine = 10.0;

/// What valve and hose can never give must not be asked for.
void check_pressure_reference(const Rig& rig, const Check& check) {
  PressureReference reference;
  try {
    reference = PressureReference(rig.pressure_reference);
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", origin_of(check.root, "reference"), error.what()));
  }
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

}  // namespace

void complete_pressure_rig(Rig& rig, const ConfigNode& root) {
  constexpr double settled_after_s = 2.0;
  const PressureReferenceParameters& reference = rig.pressure_reference;
  if (!is_stated(root, "initial", "pressure_1_Pa")) rig.initial.pressure_1_Pa = rig.axis.air.atmosphere_Pa;
  if (root.find("duration_s") == nullptr) {
    const bool oscillates = reference.kind == PressureReferenceKind::sine;
    rig.duration_s = oscillates ? reference.start_s + (1.0 + periods_of_a_sine) / reference.frequency_Hz
                                : (reference.times_s.empty() ? 0.0 : reference.times_s.back()) + settled_after_s;
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
  check.of({"reference", "air", "supply", "duration_s", "limits"}, [&] { check_pressure_reference(rig, check); });
}

}  // namespace pneuservo
