// A T-piece with a vessel on a line: it is found, with its volume and place; without its name two numbers of the line
// would take its part, which is no mistake that an owner makes.
#include <catch2/catch.hpp>

#include <cmath>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/residuals/cylinder_residuals.hpp"
#include "diagnosis/simulated_recording.hpp"
#include "diagnosis/verdict/decision.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

Rig branched_rig() {
  Rig rig = cylinder_rig(5.0);
  rig.tolerances = {{"valve.area_per_volt_m2_per_V", 0.03}, {"line_1.length_m", 0.005},
                    {"line_1.diameter_m", 0.005},           {"line_2.length_m", 0.005},
                    {"line_2.diameter_m", 0.005},           {"cylinder.dead_volume_2_m3", 0.05}};
  return rig;
}

Recording with_vessel_on_line_2() {
  Rig machine = branched_rig();
  machine.axis.effects.line_branch_2 = {1.5e-4, 0.3, 4e-3, 0.6};
  return simulated_recording(machine, 6.5, 21, all_pressures);
}

}  // namespace

TEST_CASE("a vessel on a line is named, with its volume and its place") {
  const Diagnosis found = diagnose(branched_rig(), {with_vessel_on_line_2()});
  CAPTURE(found.sentence);
  CHECK(found.verdict == Verdict::missing_physics);
  REQUIRE(found.answers.size() == 1);
  const DiagnosisAnswer& answer = found.answers.front();
  CHECK(answer.effect == "line_branch_2");
  CHECK(answer.element == "line_2");
  for (const auto& parameter : answer.parameters) {
    if (parameter.name == "volume_m3") CHECK(parameter.value == Approx(1.5e-4).epsilon(0.03));
    if (parameter.name == "position") CHECK(std::fabs(parameter.value - 0.6) < 0.05);
  }
  for (const ChannelFit& channel : found.channels)
    if (channel.column.starts_with("p2_")) CHECK(channel.held_out_after < 0.3 * channel.held_out_before);
}

TEST_CASE("a line of which length and diameter would both be wrong has something that its owner does not know") {
  const Rig owner = branched_rig();
  CylinderResiduals model(owner, {with_vessel_on_line_2()});
  FittedRows rows(model, {});
  std::vector<Candidate> known;
  for (const Candidate& candidate : all_candidates(owner, model.channels(), motion_range(model.rows())))
    if (candidate.name.starts_with("parameter:line_2")) known.push_back(candidate);
  Search search(rows, owner, known, {}, {}, {});
  search.run();
  REQUIRE(search.best_of(2) != nullptr);
  const Decision decision = decide(model, search, {});
  CAPTURE(decision.reason);
  CHECK(decision.chosen->members.size() == 2);
  CHECK(decision.verdict == Verdict::unknown);
  CHECK(decision.element == "line_2");
  CHECK(decision.reason.find("would both have to be wrong") != std::string::npos);
}
