// The search for explanations: rivals in different valleys of the tolerances, sizes that no derivative promises, a
// small effect beside a large one.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "diagnosis/closed_form_model.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/residuals/slow_error.hpp"
#include "diagnosis/search/search.hpp"
#include "diagnosis/simulated_recording.hpp"
#include "diagnosis/verdict/decision.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

constexpr double missing = 400;  ///< the residual that a name takes
constexpr double mass_kg = 2, tolerance = 0.1;

/// A load and a spring that take the same large residual. Along the mass m, in tolerances, there is a valley on either
/// side of a ridge at 0.3, which the load moves to 0: from m = 0 a fit slides to the better one with the load, and to
/// the worse one with the spring. With `stiffening` the spring that takes the residual is another one in each valley;
/// with `burden` the load leaves more than the spring does in either.
std::vector<double> two_valleys(const Rig& rig, double stiffening, double burden) {
  constexpr double ridge = 17, pull = 10;
  const double load = rig.axis.effects.motion.constant_force.force_N,
               spring = rig.axis.effects.motion.spring_load.stiffness_N_per_m;
  const double m = (rig.axis.slider.mass_kg / mass_kg - 1) / tolerance;
  const double along = m - 0.3 * (1 - load);
  return {missing * (1 - load - spring * (1 + stiffening * m)), ridge * (along * along - 1), pull * (m - 1),
          burden * load};
}

/// A spring that shows with the fourth power of its stiffness: nothing of it while it is weak.
std::vector<double> bent(const Rig& rig) {
  const double spring = rig.axis.effects.motion.spring_load.stiffness_N_per_m;
  return {missing * (1 - std::pow(spring, 4)), rig.axis.slider.mass_kg - mass_kg};
}

/// A spring with a deep valley at 2 behind a ridge and a shallow one at -1, to which its derivative points.
std::vector<double> behind_a_ridge(const Rig& rig) {
  const double spring = rig.axis.effects.motion.spring_load.stiffness_N_per_m;
  return {missing * (spring + 1) * (spring - 2) / 2, 30 * (spring - 2)};
}

/// The same spring, and a load that takes the ridge away: with it the spring slides to 2, where nothing is left for the
/// load. Alone the spring ends at -1.
std::vector<double> led_over_a_ridge(const Rig& rig) {
  const double load = rig.axis.effects.motion.constant_force.force_N;
  const std::vector<double> alone = behind_a_ridge(rig);
  return {alone[0] * (1 - load), alone[1], 5 * load};
}

/// A spring that takes much, and a load that takes little; so does an offset of the valve.
std::vector<double> much_and_little(const Rig& rig) {
  const MotionEffects<double>& motion = rig.axis.effects.motion;
  return {missing * (1 - motion.spring_load.stiffness_N_per_m),
          12 * (1 - motion.constant_force.force_N - rig.axis.effects.valve.valve_offset.offset_V)};
}

DecisionRules one_name() {
  DecisionRules rules;
  rules.most_names = 1;
  return rules;
}

Candidate found_by_size(const char* name, const char* path) {
  Candidate candidate;
  candidate.name = candidate.family = name;
  candidate.element = "motion";
  candidate.parameters = {free_number(cylinder_rig(), path)};
  candidate.negligible = candidate.neutral = {0};
  candidate.starts = {{0}};
  candidate.amplitude = {1};
  return candidate;
}

/// A search that has a spring as its only name, looked at whole at these sizes.
struct SpringSearch {
  SpringSearch(const ClosedFormModel::Residual& residual, std::vector<std::vector<double>> whole_starts)
      : model(residual), rows(model, {}), search(rows, rig(), {spring(std::move(whole_starts))}, {}, one_name(), {}) {
    search.run();
  }
  static Rig rig() {
    Rig out = cylinder_rig();
    out.tolerances = {{"slider.mass_kg", 0.02}};
    return out;
  }
  static Candidate spring(std::vector<std::vector<double>> whole_starts) {
    Candidate out = found_by_size("spring_load", "effects.spring_load.stiffness_N_per_m");
    out.whole_starts = std::move(whole_starts);
    return out;
  }

  ClosedFormModel model;
  FittedRows rows;
  Search search;
};

/// A load takes a steady mismatch from the first rows, a spring an alternating one from the last.
constexpr std::size_t drifting = 800, quick = 40;
std::vector<double> steady_and_quick(const Rig& rig) {
  const MotionEffects<double>& motion = rig.axis.effects.motion;
  std::vector<double> rows(drifting, 3 * (1 - motion.constant_force.force_N));
  for (std::size_t k = 0; k < quick; ++k)
    rows.push_back((k % 2 == 0 ? 1.2 : -1.2) * (1 - motion.spring_load.stiffness_N_per_m));
  return rows;
}

/// The first rows have a slow error, the likeliest one for a hypothesis.
class DriftingModel final : public ClosedFormModel {
 public:
  DriftingModel() : ClosedFormModel(steady_and_quick) {
    channels_.resize(2);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      rows_[k].time_s = 0.01 * static_cast<double>(k);
      rows_[k].channel = k < drifting ? 0 : 1;
      if (k < drifting) times_s_.push_back(rows_[k].time_s);
    }
  }
  LikeliestErrors likeliest_slow_errors(const Hypothesis& hypothesis) override {
    const Eigen::VectorXd column = residuals(std::span(&hypothesis, 1)).col(0);
    LikeliestErrors best{{}, -1e300};
    for (const double level : {0.0, 1.0, 3.0}) {
      Eigen::VectorXd rows = column;
      const SlowError error{1.0, level};
      const double logarithms = error.whiten(times_s_, std::span(rows.data(), drifting)),
                   likelihood = -logarithms - 0.5 * rows.squaredNorm();
      if (likelihood > best.log_likelihood) best = {{error, SlowError{}}, likelihood};
    }
    return best;
  }

 private:
  std::vector<double> times_s_;
};

}  // namespace

TEST_CASE("search: what the owner's slow error takes in has its name beside an error of its own") {
  DriftingModel model;
  FittedRows rows(model, {});
  SearchSettings settings;
  settings.grow_floor = true;
  Search search(rows, cylinder_rig(),
                {found_by_size("constant_force", "effects.constant_force.force_N"),
                 found_by_size("spring_load", "effects.spring_load.stiffness_N_per_m")},
                settings, one_name(), {});
  search.run();
  REQUIRE(search.best_of(1) != nullptr);
  CHECK(search.best_of(1)->members.front() == 0);
  CHECK(search.best_of(1)->fit.z(0) == Approx(1).epsilon(0.01));
  CHECK(search.first_gain() > DecisionRules{}.alarm_gain);
}

TEST_CASE("search: a name that small physics stands for brings nothing beside it") {
  ClosedFormModel model(much_and_little);
  FittedRows rows(model, {});
  const std::vector<Candidate> candidates{found_by_size("spring_load", "effects.spring_load.stiffness_N_per_m"),
                                          found_by_size("constant_force", "effects.constant_force.force_N")};
  DecisionRules two_names;
  two_names.most_names = 2;
  Search search(rows, cylinder_rig(), candidates, {}, two_names, {});
  search.run();
  REQUIRE(search.best_of(2) != nullptr);
  const double alone = search.best_of(2)->log_evidence - search.best_of(1)->log_evidence;
  CHECK(alone > two_names.alarm_gain);
  SearchSettings settings;
  FreeParameter small = free_number(cylinder_rig(), "effects.valve_offset.offset_V");
  small.lower = -3, small.upper = 3, small.step = 0.01;
  settings.small_physics = {small};
  const std::vector<double> gains =
      Search(rows, cylinder_rig(), candidates, settings, two_names, {}).gains_of_names(*search.best_of(2));
  REQUIRE(gains.size() == 2);
  CHECK(gains[0] > 1000);
  CHECK(gains[1] < 1);
  settings.small_physics.clear();
  CHECK(Search(rows, cylinder_rig(), candidates, settings, two_names, {}).gains_of_names(*search.best_of(2))[1] ==
        Approx(alone).margin(0.5));
}

TEST_CASE("search: a wrong number is needed where small physics explains as much by many numbers that are nothing") {
  // The spring takes all, and so does the first of thirteen small numbers; each other one has a row that says nothing.
  const auto numbers = [](const Rig& rig) {
    const ValveEffects<double>& valve = rig.axis.effects.valve;
    std::vector<double> out{valve.valve_offset.offset_V};
    for (const auto* linearity : {&valve.valve_linearity_forward, &valve.valve_linearity_backward})
      ValveLinearity<double>::visit([&](const Field&, const double& share) { out.push_back(share); }, *linearity);
    return out;
  };
  ClosedFormModel model([&](const Rig& rig) {
    std::vector<double> rows = numbers(rig);
    rows.front() = 100 * (1 - rig.axis.effects.motion.spring_load.stiffness_N_per_m - rows.front());
    for (std::size_t i = 1; i < rows.size(); ++i) rows[i] *= 50;
    return rows;
  });
  FittedRows rows(model, {});
  std::vector<Candidate> candidates{found_by_size("spring_load", "effects.spring_load.stiffness_N_per_m")};
  const bool is_owned = GENERATE(true, false);
  if (is_owned) candidates.front().kind = CandidateKind::parameter;
  Search search(rows, cylinder_rig(), candidates, {}, one_name(), {});
  search.run();
  REQUIRE(search.best_of(1) != nullptr);
  SearchSettings settings;
  const auto grant = [&](const std::string& path) {
    FreeParameter small = free_number(cylinder_rig(), path);
    small.lower = -3, small.upper = 3, small.step = 0.01;
    settings.small_physics.push_back(small);
  };
  const auto beside = [&] { return Search(rows, cylinder_rig(), candidates, settings, one_name(), {}); };
  const auto gain = [&] { return beside().gains_of_names(*search.best_of(1)).front(); };
  const double alone = search.beside_own_error(*search.best_of(1));
  grant("effects.valve_offset.offset_V");
  CHECK(gain() < 1);
  CHECK(beside().best_with_one_fewer(*search.best_of(1)) == Approx(alone).margin(0.01));  // one number for another
  for (const char* way : {"forward", "backward"})
    for (const int percent : {3, 5, 8, 12, 20, 40})
      grant("effects.valve_linearity_" + std::string(way) + ".at_" + std::to_string(percent) + "_percent");
  // Each small number that is nothing makes a machine with small physics less likely.
  CHECK(beside().best_with_one_fewer(*search.best_of(1)) < alone - 6 * std::log(50));
  // What those rows narrow each small number to; what small physics lacks would look like an effect.
  if (is_owned) CHECK(gain() == Approx(12 * std::log(50)).epsilon(0.05));
  else CHECK(gain() < 1);
}

TEST_CASE("decision: a number at the end of its tolerance is off where setting it free is likelier") {
  Rig rig = cylinder_rig();
  rig.axis.slider.mass_kg = mass_kg;
  rig.tolerances = {{"slider.mass_kg", tolerance}};
  const auto judged = [&](double true_tolerances, double told) {
    ClosedFormModel model([&](const Rig& r) {
      std::vector<double> rows(200);
      const double off = (r.axis.slider.mass_kg / mass_kg - 1) / tolerance - true_tolerances;
      for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = told * off + (k % 2 == 0 ? 1 : -1);
      return rows;
    });
    FittedRows rows(model, {});
    std::vector<Candidate> candidates = all_candidates(rig, model.channels(), MotionRange{});
    std::erase_if(candidates, [](const Candidate& c) { return c.name != "parameter:slider.mass_kg"; });
    SearchSettings settings;
    settings.grow_floor = true;
    Search search(rows, rig, candidates, settings, one_name(), {});
    search.run();
    const Decision decision = decide_beside_remainder(model, search, {});
    const double found_kg = decision.chosen->fit.hypothesis().rig.axis.slider.mass_kg;
    return std::pair(decision.verdict, (found_kg / mass_kg - 1) / tolerance);
  };
  const auto [verdict, tolerances] = judged(8, 0.1);
  CHECK(verdict == Verdict::parameter_error);
  CHECK(tolerances ==
        Approx(8 * 2 / (2 + 1.0 / 9)).epsilon(1e-3));  // 200 rows of 0.1, and a wide prior of 3 tolerances
  CHECK(judged(2, 0.1).first == Verdict::consistent);
  CHECK(judged(8, 0.01).first == Verdict::consistent);  // these rows hardly tell
}

TEST_CASE("decision: of two names nearly as likely the one that is sure of its size stands, the other is its rival") {
  // The load has two numbers of which the rows know the sum alone; they have one row that the spring does not explain.
  const auto first_of = [](double beyond_spring) {
    ClosedFormModel model([beyond_spring](const Rig& rig) {
      const double sum = rig.axis.effects.motion.constant_force.force_N + rig.axis.effects.valve.valve_offset.offset_V;
      std::vector<double> rows(200);
      for (std::size_t k = 0; k < rows.size(); ++k)
        rows[k] = 1 - rig.axis.effects.motion.spring_load.stiffness_N_per_m - sum + (k % 2 == 0 ? 1 : -1);
      rows.push_back(beyond_spring * (1 - sum));
      return rows;
    });
    FittedRows rows(model, {});
    Candidate load = found_by_size("load", "effects.constant_force.force_N");
    load.parameters.push_back(free_number(cylinder_rig(), "effects.valve_offset.offset_V"));
    load.negligible = load.neutral = {0, 0};
    load.starts = {{0, 0}};
    load.amplitude = {1, 1};
    Search search(rows, cylinder_rig(), {load, found_by_size("spring", "effects.spring_load.stiffness_N_per_m")}, {},
                  one_name(), {});
    search.run();
    const Decision decision = decide(model, search, one_name());
    CHECK(decision.rivals.size() == 2);
    CHECK(decision.probabilities.front() >= decision.probabilities.back());
    return search.candidates()[decision.chosen->members.front()].name;
  };
  CHECK(first_of(0) == "spring");
  CHECK(first_of(4) == "spring");  // 7 behind
  CHECK(first_of(8) == "load");  // 31 behind
}

TEST_CASE("decision: what changes within its owner's tolerance is no remainder, what changes by more is one") {
  const auto swings = [](const Rig&) {
    std::vector<double> rows(200);
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = 4 * std::sin(0.02 * static_cast<double>(k));
    return rows;
  };
  const auto verdict_where = [&](double stated) {
    ClosedFormModel model(swings, stated);
    FittedRows rows(model, {});
    Search search(rows, cylinder_rig(), {}, {}, one_name(), {});
    search.run();
    return decide(model, search, one_name()).verdict;
  };
  CHECK(verdict_where(0) == Verdict::unknown);
  CHECK(verdict_where(1) == Verdict::unknown);
  CHECK(verdict_where(4) == Verdict::consistent);
}

TEST_CASE("search: a rival that ended in another valley of the tolerances is fitted from where the best one stands") {
  Rig rig = cylinder_rig();
  rig.axis.slider.mass_kg = mass_kg;
  rig.tolerances = {{"slider.mass_kg", tolerance}};
  const double stiffening = GENERATE(0.0, 0.3), burden = GENERATE(0.0, 20.0);
  ClosedFormModel model([&](const Rig& r) { return two_valleys(r, stiffening, burden); });
  FittedRows rows(model, {});
  Search search(rows, rig,
                {found_by_size("constant_force", "effects.constant_force.force_N"),
                 found_by_size("spring_load", "effects.spring_load.stiffness_N_per_m")},
                {}, one_name(), {});
  search.run();
  const auto ranked = search.ranking(1);
  REQUIRE(ranked.size() == 2);
  CHECK(ranked.front()->members.front() == (burden > 0 ? 1 : 0));
  for (const Explanation* e : ranked) {
    CAPTURE(stiffening, burden, e->members.front(), e->fit.z.transpose(), e->fit.objective);
    CHECK(e->fit.z(1) > 0.5);
  }
}

TEST_CASE("search: a name that ends in a wrong valley alone is fitted once more from where a pair has led it") {
  ClosedFormModel model(led_over_a_ridge);
  FittedRows rows(model, {});
  const std::vector<Candidate> candidates{SpringSearch::spring({}),
                                          found_by_size("constant_force", "effects.constant_force.force_N")};
  for (const std::size_t most_names : {1, 2}) {
    CAPTURE(most_names);
    DecisionRules rules;
    rules.most_names = most_names;
    Search search(rows, SpringSearch::rig(), candidates, {}, rules, {});
    search.run();
    const auto ranked = search.ranking(1);
    const auto spring = std::find_if(ranked.begin(), ranked.end(), [](const auto* e) { return e->members[0] == 0; });
    REQUIRE(spring != ranked.end());
    CHECK((*spring)->fit.z(0) == Approx(most_names == 1 ? -1 : 2).margin(0.1));
    if (most_names == 2) CHECK(*spring == ranked.front());
  }
}

TEST_CASE("search: what a derivative does not promise a whole change does") {
  SpringSearch by_derivative(bent, {});
  CHECK(by_derivative.search.best_of(1) == nullptr);  // not even fitted
  SpringSearch looked_at(bent, {{0.3}});
  REQUIRE(looked_at.search.best_of(1) != nullptr);
  CHECK(looked_at.search.best_of(1)->fit.z(0) == Approx(1).epsilon(0.01));
  REQUIRE(looked_at.search.first_screening().at(0).standard_error.size() == 1);
}

TEST_CASE("search: a name that an earlier search ended with is tried, whatever it promises") {
  ClosedFormModel model(bent);
  FittedRows rows(model, {});
  const auto searched = [&](const std::vector<KnownStart>& known) {
    SearchSettings settings;
    settings.known_starts = known;
    Search search(rows, SpringSearch::rig(), {SpringSearch::spring({})}, settings, one_name(), {});
    search.run();
    return search.best_starts(3);  // for a search after it
  };
  CHECK(searched({}).empty());
  const std::vector<KnownStart> found = searched({{"spring_load", {0.3}}});
  REQUIRE(found.size() == 1);
  CHECK(found.front().name == "spring_load");
  REQUIRE(found.front().z.size() == 1);
  CHECK(found.front().z.front() == Approx(1).epsilon(0.01));
}

TEST_CASE("search: a name is fitted from its derivative and from its best whole change, the better is kept") {
  CHECK(SpringSearch(behind_a_ridge, {}).search.best_of(1)->fit.z(0) == Approx(-1).margin(0.1));
  CHECK(SpringSearch(behind_a_ridge, {{1.5}}).search.best_of(1)->fit.z(0) == Approx(2).margin(0.1));
}

TEST_CASE("search: fittings, branches and dead times have such sizes, a branch at every place that is looked at") {
  const ResidualChannel port{"p1_port", "Pa", 300, 50};
  for (const Candidate& candidate : all_candidates(cylinder_rig(), {port}, {-0.1, 0.1, 0.5})) {
    if (candidate.name.starts_with("line_restriction")) CHECK(candidate.whole_starts.size() == 3);
    else if (candidate.name.starts_with("flow_control")) CHECK(candidate.whole_starts.size() == 1);
    else if (candidate.name.starts_with("end_cushion")) CHECK(candidate.whole_starts.size() == 2);
    else if (candidate.name == "command_delay") CHECK(candidate.whole_starts.size() == 12);  // periods
    else if (candidate.name.starts_with("line_branch"))
      CHECK(candidate.whole_starts.size() == 2 * candidate.starts.size());
    else CHECK(candidate.whole_starts.empty());
    for (const std::vector<double>& whole : candidate.whole_starts) {
      REQUIRE(whole.size() == candidate.parameters.size());
      CHECK(whole.front() > 0);  // the size; everything else is a place of the grid
      const auto is_beside = [&](const std::vector<double>& start) {
        return std::equal(start.begin() + 1, start.end(), whole.begin() + 1);
      };
      CHECK(std::any_of(candidate.starts.begin(), candidate.starts.end(), is_beside));
    }
  }
}

TEST_CASE("search: a small leak is named beside a leak of the spool fifty times as large") {
  const Rig owner = toleranced_cylinder_rig(10.0, 4.15e-3);
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
