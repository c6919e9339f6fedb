// What no single key of a control law can be checked for; most laws need nothing.
#include "config/law_checks.hpp"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "config/number_text.hpp"

namespace pneuservo {
namespace {

void check_parameters(const auto&, const Rig&, const Check&) {}
void check_parameters(const PdForceParameters& p, const Rig& rig, const Check& check) {
  if (p.wants_pass() && p.without_pass == WithoutPass::refuse && rig.reference.kind == ReferenceKind::live)
    check.refuse("controller.flow_feedforward", {"reference.kind"}, "pass",
                 "off or formula with reference.kind live, or without_pass: formula: a move whose pass is not ready in "
                 "time goes by the formula");
  if (p.learning != MoveLearning::none && !p.wants_pass())
    check.refuse("controller.learning", {"controller.flow_feedforward"}, "command",
                 "none, or controller.flow_feedforward: pass, beside whose command it learns");
}
void check_parameters(const Ppd2Parameters& p, const Rig& rig, const Check& check) {
  if (p.observer_gains && p.observer_gains->size() != 3)
    check.refuse("controller.observer_gains", {}, fmt::format("{} numbers", p.observer_gains->size()),
                 "three: l1, l2, l3");
  const std::string name(feedforward_kind_names[static_cast<std::size_t>(p.feedforward)]);
  const bool needs_lag = p.feedforward == FeedforwardKind::order_5 || p.feedforward == FeedforwardKind::order_7;
  if (needs_lag && !(rig.axis.line_1.natural_frequency_Hz > 0.0))
    check.refuse("controller.feedforward", {"line_1.natural_frequency_Hz"}, name,
                 "none, 3 or flatness, or line_1.natural_frequency_Hz and damping_ratio of the lines");
  if (p.feedforward == FeedforwardKind::flatness && rig.reference.kind == ReferenceKind::live)
    check.refuse("controller.feedforward", {"reference.kind"}, name,
                 "none, 3, 5 or 7 with reference.kind live: flatness plans the whole reference before it moves");
  if (p.feedforward == FeedforwardKind::flatness && p.observer != ObserverInput::error)
    check.refuse("controller.observer", {"controller.feedforward"}, "measured",
                 "error: feedforward flatness has its own commands");
  for (const auto& [key, pressure] : {std::pair{"equilibrium_pressure_Pa", p.equilibrium_pressure_Pa},
                                      std::pair{"mean_pressure_Pa", p.mean_pressure_Pa}})
    if (!(pressure > rig.axis.air.atmosphere_Pa && pressure < rig.axis.supply.pressure_Pa))
      check.refuse(std::string("controller.") + key, {"supply.pressure_Pa", "air.atmosphere_Pa"}, number_text(pressure),
                   fmt::format("a pressure between air.atmosphere_Pa ({}) and supply.pressure_Pa ({})",
                               number_text(rig.axis.air.atmosphere_Pa), number_text(rig.axis.supply.pressure_Pa)));
  if (!(p.position_gain_V_per_m > 0.0))
    check.refuse("controller.position_gain_V_per_m", {}, number_text(p.position_gain_V_per_m), "more than 0");
}

}  // namespace

void check_law(const Rig& rig, const Check& check) {
  rig.controller.in_use([&](const auto& parameters) { check_parameters(parameters, rig, check); });
}

}  // namespace pneuservo
