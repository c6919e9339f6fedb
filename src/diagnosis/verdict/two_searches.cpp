// Two searches, without small physics and with it, and which of their verdicts counts.
#include "diagnosis/verdict/two_searches.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "diagnosis/residuals/fitted_rows.hpp"

namespace pneuservo {

namespace {

/// Beside small physics the residual is not smooth, and fits creep on: by a twentieth of an alarm's gain in all.
constexpr double settled_gain_beside = 3.0;

/// Whether a shape was found that is no larger than what every machine has of it.
bool describes_small_physics(const Search& search, const Decision& decision) {
  if (!decision.is_described) return false;
  const std::vector<FreeParameter> small = search.small_physics_of_all();
  const Fit& fit = decision.chosen->fit;
  return std::all_of(fit.parameters.begin(), fit.parameters.begin() + static_cast<std::ptrdiff_t>(fit.own_count),
                     [&](const FreeParameter& own) {
                       const double value = own.value(fit.z(fit.own_place(own)));
                       return std::any_of(small.begin(), small.end(), [&](const FreeParameter& granted) {
                         return granted.path == own.path && granted.z(value) >= granted.lower &&
                                granted.z(value) <= granted.upper;
                       });
                     });
}

/// Whether the verdict needs more than any one machine should lack: as many names as are ever sought, or more of the
/// owner's tolerances at the end of their range than any owner errs by; or whether held-out stretches speak against it.
/// Then names may stand for small physics that is everywhere, as a small shape does.
bool is_doubtful(const Rig& rig, const Search& search, const Decision& decision, const DecisionRules& rules) {
  if (!rig.is_pneumatic() || decision.verdict == Verdict::consistent) return false;
  if (decision.is_shaken) return false;  // its levels are the owner's, and names would follow the shaking
  if (describes_small_physics(search, decision)) return true;
  // Names that fit and do not go on: what they stand for is not what is missing.
  if (decision.verdict == Verdict::unknown && !decision.is_described &&
      decision.levels.held_out_excess() > rules.worse_fit)
    return true;
  return std::max(decision.chosen->members.size(), tolerances_at_end(rig, decision.chosen->fit)) >= rules.most_names;
}

/// Small physics beside the tolerances, but for what names say already.
SearchSettings beside_small_physics(const Search& search, const std::vector<std::size_t>& named) {
  SearchSettings settings;
  settings.small_physics = search.small_physics_of_all();
  settings.left_out = search.left_out();
  settings.settled_gain = settled_gain_beside;
  std::erase_if(settings.small_physics, [&](const FreeParameter& granted) {
    return std::any_of(named.begin(), named.end(),
                       [&](std::size_t m) { return stands_for(granted, search.candidates()[m]); });
  });
  return settings;
}

/// Whether small physics has what a name says.
bool is_in_small_physics(const Search& search, const Candidate& name) {
  const std::vector<FreeParameter> small = search.small_physics_of_all();
  return std::any_of(small.begin(), small.end(),
                     [&](const FreeParameter& granted) { return stands_for(granted, name); });
}

/// Whether a machine with one name fewer and small physics is likelier than one with the names alone. It is asked where
/// small physics has what a name says: every machine has some dead band.
bool is_small_physics_likelier(const Rig& rig, FittedRows& rows, Search& search, const Decision& decision,
                               const DecisionRules& rules) {
  const std::vector<std::size_t>& members = decision.chosen->members;
  if (!rig.is_pneumatic() || decision.verdict == Verdict::unknown) return false;
  if (std::none_of(members.begin(), members.end(),
                   [&](std::size_t m) { return is_in_small_physics(search, search.candidates()[m]); }))
    return false;
  const double alone = search.beside_own_error(*decision.chosen);
  Search beside(rows, rig, search.candidates(), beside_small_physics(search, {}), rules, {});
  return beside.best_with_one_fewer(*decision.chosen) > alone;
}

/// Those of the names that bring enough where small physics stands beside them all: others may stand for that. What
/// small physics has itself is asked otherwise (is_small_physics_likelier).
std::vector<std::size_t> needed_names(const Rig& rig, FittedRows& rows, const Search& search, const Decision& decision,
                                      const DecisionRules& rules) {
  const std::vector<std::size_t>& members = decision.chosen->members;
  if (!rig.is_pneumatic() || decision.verdict == Verdict::unknown || members.empty()) return members;
  Search beside(rows, rig, search.candidates(), beside_small_physics(search, members), rules, {});
  const std::vector<double> gains = beside.gains_of_names(*decision.chosen);
  std::vector<std::size_t> needed;
  for (std::size_t i = 0; i < members.size(); ++i)
    if (gains[i] >= rules.alarm_gain || is_in_small_physics(search, search.candidates()[members[i]]))
      needed.push_back(members[i]);
  return needed;
}

/// Whether a decision leaves about as little as another, fitted and held-out rows together.
bool fits_as_well(const Decision& decision, const Decision& other, const DecisionRules& rules) {
  const double left = decision.levels.chi2(false) + decision.levels.chi2(true),
               others = other.levels.chi2(false) + other.levels.chi2(true);
  return left <= rules.worse_fit * others;
}

/// Names of the search without small physics that the search with it refits, whatever they promise: beside an owner's
/// fit that small physics has bent, a delay of 6 ms promised less than eleven others, and it was the truth.
constexpr std::size_t refitted_anyway = 4;

/// Of each channel, the standard deviation of a row [unit of the channel], root mean square.
std::vector<double> row_sigmas(const ResidualModel& model) {
  std::vector<double> out;
  const Eigen::VectorXd any = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.rows().size()));
  for (const ChannelLevel& level : channel_levels(model.rows(), model.channels().size(), any))
    out.push_back(level.sigma);
  return out;
}

/// The search and its verdict with small physics free beside the tolerances; what that leaves is warned of.
Decision with_small_physics(const Rig& rig, FittedRows& rows, std::vector<Candidate> candidates, const Search& plain,
                            const DecisionRules& usual, const Search::Progress& progress, std::optional<Search>& search,
                            std::vector<std::string>& warnings) {
  ResidualModel& model = rows.model();
  SearchSettings settings;
  settings.progress = later_search;
  settings.small_physics = plain.small_physics_of_all();
  settings.left_out = plain.left_out();
  settings.known_starts = plain.best_starts(refitted_anyway);
  settings.grow_floor = true;
  settings.settled_gain = settled_gain_beside;
  std::erase_if(candidates, is_granted);
  DecisionRules rules = usual;
  rules.most_names = 2;
  search.emplace(rows, rig, std::move(candidates), settings, rules, progress);
  search->run();
  const Explanation* best = search->best_of(1);
  rows.drop_slow_error();
  const LikeliestErrors errors = model.likeliest_slow_errors((best ? *best : search->owner()).fit.hypothesis());
  const std::vector<double> sigmas = row_sigmas(model);
  for (std::size_t c = 0; c < sigmas.size(); ++c)
    if (const double level = errors.of_channel[c].level * sigmas[c]; level > 0)
      warnings.push_back(fmt::format("{}: small physics without a name leaves about {:.3g} {}",
                                     model.channels()[c].name, level, model.channels()[c].unit));
  return decide_beside_remainder(model, *search, usual);
}

}  // namespace

Decision decided(const Rig& rig, ResidualModel& model, Search& search, const DecisionRules& rules) {
  Decision decision = decide(model, search, rules);
  if (model.simulates() && search.settle(*decision.chosen)) judge_what_is_left(model, search, rules, decision);
  const bool leaves_something = decision.levels.highest() > rules.floor_level;
  if (!rig.is_pneumatic() && !decision.is_shaken &&
      (decision.verdict == Verdict::unknown || leaves_something || !rig.has_controller()))
    decision = decide_in_one_quantity(model, search, rules);
  return decision;
}

std::vector<Screened> screened_beside(const Rig& rig, FittedRows& rows, const Search& search, const Decision& decision,
                                      const DecisionRules& rules) {
  if (!rig.is_pneumatic() || search.grants_small_physics()) return search.first_screening();
  const Explanation& chosen = *decision.chosen;
  Search beside(rows, rig, search.candidates(), beside_small_physics(search, chosen.members), rules, {});
  return beside.screened_at(chosen);
}

Decision decided_twice(const Rig& rig, FittedRows& rows, Search& search, const DecisionRules& rules,
                       const Search::Progress& progress, std::optional<Search>& beside,
                       std::vector<std::string>& warnings) {
  ResidualModel& model = rows.model();
  Decision decision = decided(rig, model, search, rules);
  const bool left_everywhere = decision.verdict == Verdict::unknown && !decision.is_described &&
                               is_everywhere(model.channels(), decision.levels.channels, rules.floor_level);
  const std::vector<std::size_t> needed = needed_names(rig, rows, search, decision, rules);
  const bool is_each_needed = needed.size() == decision.chosen->members.size();
  if (!left_everywhere && is_each_needed && !is_doubtful(rig, search, decision, rules) &&
      !is_small_physics_likelier(rig, rows, search, decision, rules))
    return decision;
  Decision granted = with_small_physics(rig, rows, search.candidates(), search, rules, progress, beside, warnings);
  const bool is_shape_needed = decision.is_described && granted.verdict == Verdict::unknown;
  if (left_everywhere || (!is_shape_needed && fits_as_well(granted, decision, rules))) return granted;
  // A single name has no fewer behind it: it stays where small physics does not fit as well.
  if (!is_each_needed && decision.chosen->members.size() > 1) {
    const std::vector<const Explanation*> fewer = search.ranking(needed.size());
    const auto same =
        std::find_if(fewer.begin(), fewer.end(), [&](const Explanation* e) { return e->members == needed; });
    if (needed.empty() || same == fewer.end()) return granted;
    model.set_working_point((*same)->fit.hypothesis());
    decision = decide_on(**same, model, search, rules);
    if (decision.verdict == Verdict::unknown) return granted;
  }
  beside.reset();  // what was doubted explains what small physics and one name do not
  warnings.clear();
  model.set_working_point(decision.chosen->fit.hypothesis());
  return decision;
}

}  // namespace pneuservo
