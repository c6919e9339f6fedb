// One planned move from rest to rest as a reference of its own.
#include "pass/move_pass.hpp"

#include <algorithm>
#include <exception>
#include <memory>

#include <fmt/format.h>

namespace pneuservo {
namespace {

/// Learned beyond the end of the move: its rest, which the last tick then stands for.
constexpr double settling_s = 0.25;

std::string formula_words(const PlannedMove& move, const std::string& why) {
  return fmt::format("the move from {:.4g} to {:.4g} m goes by the formula: {}", move.from_m, move.to_m, why);
}

}  // namespace

std::string MovePassMaker::late_words(const PlannedMove& move) {
  return formula_words(move, "its pass was not ready within reference.pass_within_s");
}

MovePassMaker::MovePassMaker(const Rig& rig) : rig_(rig) {
  planner_.configure(live_limits(rig.reference), rig.period_s);
  law_.configure(rig.controller.of<PdForce>(),
                 LawSetup{rig_.axis, rig.period_s, Reference(), rig.duration_s, std::make_shared<PassTable>()});
}

// The loop's planner has the same line, later.
std::shared_ptr<const LivePlanner> MovePassMaker::planned(const PlannedMove& move) const {
  auto planner = std::make_shared<LivePlanner>(planner_);
  planner->start(0, move.from_m);
  planner->move_to(0, move.to_m, move.speed_mps);
  return planner;
}

std::string MovePassMaker::make(const MovePassRequest& request, MovePass& out, const GoesOn& goes_on) {
  out.law.clear(), out.prediction.clear();
  if (!goes_on()) return {};
  const Reference reference(planned(request.move));
  Rig rig = rig_;
  rig.duration_s = reference.end_s() + settling_s;
  rig.initial.pressure_1_Pa =
      std::clamp(request.pressure_1_Pa, rig.axis.air.atmosphere_Pa, rig.axis.supply.pressure_Pa);
  rig.initial.pressure_2_Pa.reset();
  const auto refused = [&](const std::string& why) {
    out.law.clear(), out.prediction.clear();
    return formula_words(request.move, why);
  };
  if (const double ticks = rig.duration_s / rig.period_s; ticks > static_cast<double>(most_pass_ticks))
    return refused(fmt::format("it takes {:.0f} periods, a pass has at most {}", ticks, most_pass_ticks));
  try {
    const CommandPass pass = make_command_pass(rig, reference, {}, goes_on);
    if (!goes_on()) return {};
    if (const std::string why = refusal_words(rig, reference, pass, PassWords::short_words); !why.empty())
      return refused(why);
    out.law = law_.pass_ticks(*pass.table(rig, true), reference);
    out.prediction = law_.pass_ticks(*pass.table(rig, false), reference);
  } catch (const std::exception& error) { return refused(error.what()); }  // no memory: the axis goes on
  return {};
}

}  // namespace pneuservo
