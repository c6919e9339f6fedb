// The search for explanations: rivals in different valleys of the tolerances, sizes that no derivative promises, a
// small effect beside a large one.
#include <catch2/catch.hpp>

#include <cmath>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/search.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

/// A load and a spring that take the same large residual. Along the mass m, in tolerances, there is a valley on either
/// side of a ridge at 0.3, which the load moves to 0: from m = 0 a fit slides to the better one with the load, and to
/// the worse one with the spring.
class TwoValleys : public ResidualModel {
 public:
  static constexpr double missing = 400, ridge = 17, pull = 10, mass_kg = 2, tolerance = 0.1;
  TwoValleys() : channels_(1), rows_(4) {}
  const std::vector<ResidualChannel>& channels() const override { return channels_; }
  const std::vector<ResidualRow>& rows() const override { return rows_; }
  Eigen::MatrixXd residuals(std::span<const Hypothesis> hypotheses) override {
    Eigen::MatrixXd out(4, static_cast<Eigen::Index>(hypotheses.size()));
    for (Eigen::Index i = 0; i < out.cols(); ++i) {
      const auto& axis = hypotheses[static_cast<std::size_t>(i)].rig.axis;
      const double load = axis.effects.motion.constant_force.force_N,
                   spring = axis.effects.motion.spring_load.stiffness_N_per_m;
      const double m = (axis.slider.mass_kg / mass_kg - 1) / tolerance;
      const double along = m - 0.3 * (1 - load);
      out(0, i) = missing * (1 - load - spring);
      out(1, i) = ridge * (along * along - 1);
      out(2, i) = pull * (m - 1);
      out(3, i) = 0;
    }
    return out;
  }
  std::vector<ChannelMisfit> sample_misfit(const Hypothesis&) override { return {}; }
  std::vector<ResidualCourse> courses(const Hypothesis&) override { return {}; }

 private:
  std::vector<ResidualChannel> channels_;
  std::vector<ResidualRow> rows_;
};

/// A spring that shows with the fourth power of its stiffness: nothing of it while it is weak.
class Bent : public ResidualModel {
 public:
  static constexpr double missing = 400;
  Bent() : channels_(1), rows_(2) {}
  const std::vector<ResidualChannel>& channels() const override { return channels_; }
  const std::vector<ResidualRow>& rows() const override { return rows_; }
  Eigen::MatrixXd residuals(std::span<const Hypothesis> hypotheses) override {
    Eigen::MatrixXd out(2, static_cast<Eigen::Index>(hypotheses.size()));
    for (Eigen::Index i = 0; i < out.cols(); ++i) {
      const auto& axis = hypotheses[static_cast<std::size_t>(i)].rig.axis;
      const double spring = axis.effects.motion.spring_load.stiffness_N_per_m;
      out(0, i) = missing * (1 - std::pow(spring, 4));
      out(1, i) = axis.slider.mass_kg - 2;
    }
    return out;
  }
  std::vector<ChannelMisfit> sample_misfit(const Hypothesis&) override { return {}; }
  std::vector<ResidualCourse> courses(const Hypothesis&) override { return {}; }

 private:
  std::vector<ResidualChannel> channels_;
  std::vector<ResidualRow> rows_;
};

Candidate amplitude(const char* name, const char* path) {
  Candidate candidate;
  candidate.name = candidate.family = name;
  candidate.element = "motion";
  FreeParameter size;
  size.path = path;
  candidate.parameters = {size};
  candidate.negligible = candidate.neutral = {0};
  candidate.starts = {{0}};
  candidate.amplitude = {1};
  return candidate;
}

}  // namespace

TEST_CASE("search: a rival that ended in another valley of the tolerances is fitted from where the best one stands") {
  Rig rig = cylinder_rig();
  rig.axis.slider.mass_kg = TwoValleys::mass_kg;
  rig.tolerances = {{"slider.mass_kg", TwoValleys::tolerance}};
  TwoValleys model;
  FittedRows rows(model, {});
  SearchSettings settings;
  settings.most_effects = 1;
  Search search(rows, rig,
                {amplitude("constant_force", "effects.constant_force.force_N"),
                 amplitude("spring_load", "effects.spring_load.stiffness_N_per_m")},
                settings, DecisionRules{}, {});
  search.run();
  const auto ranked = search.ranking(1);
  REQUIRE(ranked.size() == 2);
  for (const Explanation* e : ranked) {
    CAPTURE(e->members.front(), e->fit.z.transpose(), e->fit.objective);
    CHECK(e->fit.z(1) > 0.5);
  }
}

/// Most numbers known to some percent, and none of them what the owner says.
Rig owners_rig(double length_m, double diameter_m) {
  Rig rig = cylinder_rig(length_m, diameter_m);
  rig.tolerances = {{"slider.mass_kg", 0.02},
                    {"slider.viscous_friction_Ns_per_m", 0.1},
                    {"line_1.length_m", 0.005},
                    {"line_2.length_m", 0.005},
                    {"line_1.diameter_m", 0.01},
                    {"line_2.diameter_m", 0.01},
                    {"cylinder.dead_volume_1_m3", 0.05},
                    {"cylinder.dead_volume_2_m3", 0.05},
                    {"valve.area_per_volt_m2_per_V", 0.03}};
  return rig;
}

TEST_CASE("search: what a derivative does not promise a whole change does") {
  Rig rig = cylinder_rig();
  rig.tolerances = {{"slider.mass_kg", 0.02}};
  Bent model;
  FittedRows rows(model, {});
  SearchSettings settings;
  settings.most_effects = 1;
  Candidate spring = amplitude("spring_load", "effects.spring_load.stiffness_N_per_m");
  SECTION("by its derivative alone it is not even fitted") {
    Search search(rows, rig, {spring}, settings, DecisionRules{}, {});
    search.run();
    CHECK(search.best_of(1) == nullptr);
  }
  SECTION("with a size to look at it is found") {
    spring.whole_starts = {{0.3}};
    Search search(rows, rig, {spring}, settings, DecisionRules{}, {});
    search.run();
    REQUIRE(search.best_of(1) != nullptr);
    CHECK(search.best_of(1)->fit.z(0) == Approx(1).epsilon(0.01));
    REQUIRE(search.first_screening().at(0).standard_error.size() == 1);
  }
}

TEST_CASE("search: fittings and branches have such sizes, a branch at every place that is looked at") {
  const ResidualChannel port{"p1_port", "Pa", 300, 50};
  for (const Candidate& candidate : all_candidates(cylinder_rig(), {port}, {-0.1, 0.1, 0.5})) {
    if (candidate.name.starts_with("line_restriction")) CHECK(candidate.whole_starts.size() == 3);
    else if (candidate.name.starts_with("line_branch"))
      CHECK(candidate.whole_starts.size() == 2 * candidate.starts.size());
    else CHECK(candidate.whole_starts.empty());
    for (const std::vector<double>& start : candidate.whole_starts) CHECK(start.size() == candidate.parameters.size());
  }
}

TEST_CASE("search: a small leak is named beside a leak of the spool fifty times as large") {
  const Rig owner = owners_rig(10.0, 4.15e-3);
  Rig machine = owner;
  machine.axis.effects.valve.valve_neutral_leak.area_m2 = 8e-8;
  machine.axis.effects.chamber_leak_1.area_m2 = 1.6e-9;
  const Diagnosis diagnosis = diagnose(owner, {simulated_recording(machine, 8.0, 17, all_pressures)});
  CAPTURE(diagnosis.sentence);
  REQUIRE(diagnosis.answers.size() == 2);
  CHECK(diagnosis.answers[0].effect == "valve_neutral_leak");
  CHECK(diagnosis.answers[0].parameters.at(0).value == Approx(8e-8).epsilon(0.02));
  CHECK(diagnosis.answers[1].effect == "chamber_leak_1");
  CHECK(diagnosis.answers[1].parameters.at(0).value == Approx(1.6e-9).epsilon(0.15));
}
