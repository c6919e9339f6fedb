// Where small physics brings all to its floor, but only at the end of what is granted: what is named then.
#include <catch2/catch.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "config/rig_parameters.hpp"
#include "diagnosis/closed_form_model.hpp"
#include "diagnosis/search/search.hpp"
#include "diagnosis/simulated_recording.hpp"
#include "diagnosis/verdict/decision.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

constexpr const char *load_force = "effects.constant_force.force_N", *slider_mass = "slider.mass_kg";
constexpr double missing_N = 1, row_noise = 0.95;
constexpr int rows_at_end = 400;

Rig rig_of_two_kg() {
  Rig out = cylinder_rig();
  out.axis.slider.mass_kg = 2;
  return out;
}

FreeParameter freed_within(const Rig& rig, const std::string& path, double spread, double most) {
  FreeParameter out = free_number(rig, path);
  out.center = out.value_in(rig);
  out.spread = spread;
  out.lower = -most;
  out.upper = most;
  return out;
}

Candidate candidate_at(const Rig& rig, const std::string& name, const std::string& path, double spread) {
  Candidate out;
  out.name = out.family = name;
  out.element = "motion";
  out.kind = name.starts_with("parameter:") ? CandidateKind::parameter : CandidateKind::effect;
  out.parameters = {freed_within(rig, path, spread, 40)};
  out.negligible = {0};
  out.neutral = {out.parameters.front().center};
  out.starts = {{0}};
  out.amplitude = {1};
  return out;
}

constexpr double stated_share = 0.02;
double off_by(const Rig& rig, const std::string& path) {
  return get_parameter(rig, path) / get_parameter(rig_of_two_kg(), path) - 1;
}

/// What is decided beside small physics that may grant a load of 0.3 N. `missing` is what a row leaves beside its
/// noise.
struct DecidedAtEnd {
  using Missing = std::function<double(const Rig& rig, int row)>;
  DecidedAtEnd(const std::vector<std::string>& tolerances, bool grants_load, const Missing& missing)
      : owner(rig_of_two_kg()), model(rows_of(missing)), rows(model, {}) {
    for (const std::string& path : tolerances) owner.tolerances[path] = stated_share;
    SearchSettings settings;
    settings.grow_floor = true;
    if (grants_load) settings.small_physics = {freed_within(owner, load_force, 0.1, 3)};
    const std::vector<Candidate> candidates{candidate_at(owner, "constant_force", load_force, 1),
                                            candidate_at(owner, "parameter:slider.mass_kg", slider_mass, 0.6)};
    search.emplace(rows, owner, candidates, settings, DecisionRules{}, Search::Progress{});
    search->run();
    decision = decide_beside_remainder(model, *search, {});
  }
  std::string name() const {
    return decision.chosen->members.empty() ? "" : search->candidates()[decision.chosen->members.front()].name;
  }
  static ClosedFormModel::Residual rows_of(const Missing& missing) {
    return [missing](const Rig& rig) {
      std::vector<double> out;
      for (int k = 0; k < rows_at_end; ++k) out.push_back((k % 2 == 0 ? row_noise : -row_noise) + missing(rig, k));
      return out;
    };
  }

  Rig owner;
  ClosedFormModel model;
  FittedRows rows;
  std::optional<Search> search;
  Decision decision;
};

}  // namespace

TEST_CASE("what is at the end of what every machine is granted is named where free it is clearly likelier") {
  const DecidedAtEnd decided({}, true,
                             [](const Rig& rig, int) { return 0.8 * (missing_N - get_parameter(rig, load_force)); });
  REQUIRE(decided.search->owner_wants_more(*decided.search->best_of(1)));
  CHECK(decided.decision.verdict == Verdict::missing_physics);
  CHECK(decided.name() == "constant_force");
}

TEST_CASE("a number at the end of its tolerance is not off where another name is clearly likelier still") {
  const DecidedAtEnd decided({slider_mass}, false, [](const Rig& rig, int row) {
    const double of_mass = row < rows_at_end / 2 ? 0.4 * off_by(rig, slider_mass) / (3 * stated_share) : 0.0;
    return 0.8 * (missing_N - get_parameter(rig, load_force)) - of_mass;
  });
  REQUIRE(decided.search->ranking(1).size() == 2);
  REQUIRE(decided.search->owner_wants_more(*decided.search->ranking(1)[1]));
  CHECK(decided.decision.verdict == Verdict::consistent);
}

TEST_CASE("an owner's model is refuted that needs as many tolerances at their ends as no owner errs by") {
  const std::vector<std::string> paths{"supply.pressure_Pa", "line_1.length_m", "line_2.length_m"};
  const bool is_relieved = GENERATE(true, false);
  const DecidedAtEnd decided(paths, false, [&](const Rig& rig, int) {
    double left = 1;
    for (const std::string& path : paths) left -= 0.2 * off_by(rig, path) / (3 * stated_share);
    return is_relieved ? left - get_parameter(rig, load_force) : left;
  });
  CHECK(tolerances_at_end(decided.owner, decided.search->owner().fit) == 3);
  CHECK(decided.decision.verdict == (is_relieved ? Verdict::missing_physics : Verdict::unknown));
}
