// The course of a search: screening by derivatives, refits of what promises most, pairs with swaps, more.
#include "diagnosis/search/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "diagnosis/residuals/periodic_supply.hpp"
#include "diagnosis/verdict/left_over.hpp"

namespace pneuservo {

namespace {

/// A fit further than this from the floor (chi2 per row) has been bent by what is missing: screen from where the owner
/// stands instead.
constexpr double bent_chi2_per_row = 3;
/// How often the floor and the owner's fit follow each other: then neither moves any more.
constexpr int floor_rounds = 2;

bool is_behind(const std::pair<double, Explanation*>& a, const std::pair<double, Explanation*>& b) {
  return a.first < b.first;
}

}  // namespace

Search::Search(FittedRows& rows, const Rig& rig, std::vector<Candidate> candidates, SearchSettings settings,
               const DecisionRules& rules, Progress progress)
    : rows_(rows), rig_(rig), candidates_(std::move(candidates)), settings_(std::move(settings)), rules_(rules),
      progress_(std::move(progress)),
      nuisances_(nuisances(rig, rows.model().start_factor_count(), rows.model().start_factor_sigma())) {
  nuisances_.insert(nuisances_.end(), settings_.small_physics.begin(), settings_.small_physics.end());
}

void Search::tell(double share, const std::string& what) const {
  if (progress_)
    progress_(std::lerp(settings_.progress.begin, settings_.progress.end, share),
              what + (settings_.grow_floor ? ", with small physics" : ""));
}

std::vector<std::size_t> Search::others(const std::vector<std::size_t>& members) const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    if (!contains(members, i) && (members.empty() || !candidates_[i].is_never_added)) out.push_back(i);
  return out;
}

std::vector<Screened> Search::worth_refitting(std::vector<Screened> screened, std::size_t count) const {
  std::stable_sort(screened.begin(), screened.end(),
                   [](const Screened& a, const Screened& b) { return a.gain > b.gain; });
  const double least =
      screened.empty() ? 0 : std::max(settings_.least_gain, settings_.least_share * screened.front().gain);
  std::erase_if(screened, [&](const Screened& s) { return s.gain < least; });
  if (screened.size() > count) screened.resize(count);
  return screened;
}

void Search::add_known(std::vector<Screened>& chosen) const {
  for (const KnownStart& known : settings_.known_starts)
    for (std::size_t i = 0; i < candidates_.size(); ++i)
      if (candidates_[i].name == known.name &&
          std::none_of(chosen.begin(), chosen.end(), [&](const Screened& s) { return s.candidate == i; }))
        chosen.push_back({i, 0, known.z, {}});
}

void Search::take_defect_at_best(std::size_t members) {
  const Explanation* best = best_of(members);
  if (best == nullptr || best->log_evidence - owner_.log_evidence < rules_.doubted_gain) return;
  // Fitted to its end there first, and once more at the error that it has there: a fit that moves on leaves an error.
  for (int round = 0; round < 2; ++round) {
    polish({&tried_.at(best->members)}, 6);
    rows_.model().set_working_point(best->fit.hypothesis());
  }
  working_point_ = best->members;
  std::vector<Explanation*> again = rivals(members, settings_.rival_distance, 12);
  if (members > 1)
    for (Explanation* e : rivals(members - 1, settings_.rival_distance, 2)) again.push_back(e);
  again.push_back(&owner_);
  polish(again, 2, Anew::own);
  owner_.log_evidence = std::max(owner_.log_evidence, owner_evidence_at_home_);
  linearise(rows_, {&as_configured_});
}

bool Search::settle(const Explanation& explanation) {
  if (explanation.members == working_point_) return false;
  Explanation& own = explanation.members.empty() ? owner_ : tried_.at(explanation.members);
  rows_.model().set_working_point(own.fit.hypothesis());
  working_point_ = own.members;
  polish({&own}, 6);
  linearise(rows_, {&as_configured_});
  return true;
}

void Search::add_families(const Fit& base, const std::vector<std::size_t>& members,
                          const std::vector<Screened>& screened) {
  std::set<std::string> families;
  for (const Explanation* e : rivals(members.size() + 1, settings_.rival_distance, 3))
    for (const std::size_t member : e->members) families.insert(candidates_[member].family);
  std::vector<Screened> relatives;
  for (const Screened& s : screened)
    if (families.count(candidates_[s.candidate].family) && s.gain > settings_.least_gain) relatives.push_back(s);
  refit(base, members, relatives);
}

void Search::search_singles() {
  tell(0, "owner's model");
  as_configured_ = start_fit({});
  linearise(rows_, {&as_configured_});
  if (as_configured_.failed) throw std::runtime_error("the rig as configured cannot be simulated on these recordings");
  fit_owner();
  tell(0.1, "screening of all names");
  const bool bent = is_bent() && !settings_.grow_floor;
  if (!bent) take_defect_at_owner();
  const Fit& base = bent ? as_configured_ : owner_.fit;
  const Screening screening(rows_, base, candidates_, others({}));
  first_screening_ = screening.singles();
  first_pairs_ = screening.best_pairs(settings_.pairs);
  tell(0.2, "refits");
  std::vector<Screened> chosen = worth_refitting(first_screening_, settings_.refits);
  add_known(chosen);
  refit(base, {}, chosen);
  add_families(base, {}, first_screening_);
  std::vector<Screened> beside_fit;
  if (bent) {
    // Far from its truth an explanation may promise little at the owner's values and all beside the best that the
    // owner's model can do: exhaust edges 8 % narrower promised 0.2 % of what a wrong valve area did.
    beside_fit = Screening(rows_, owner_.fit, candidates_, others({})).singles();
    refit(owner_.fit, {}, worth_refitting(beside_fit, settings_.refits));
    add_families(owner_.fit, {}, beside_fit);
  }
  tell(0.35, "the best to their ends");
  take_defect_at_best(1);
  polish_best(1);
  // A name that has come forward since brings its relatives: a lag was the best without its dead time being tried.
  const std::size_t known = tried_.size();
  add_families(base, {}, first_screening_);
  add_families(owner_.fit, {}, beside_fit);
  if (tried_.size() > known) polish_best(1);
  settle_in_deepest_valley(1);
  if (restart_siblings()) polish_best(1);
  refit_owner_at_best();
  if (const Explanation* best = best_of(1)) first_gain_ = best->log_evidence - owner_.log_evidence;
  if (settings_.grow_floor) take_floor_at_best();
}

// From the values of the best name: a fit that ended in a valley of its own makes a name of what the owner grants.
void Search::refit_owner_at_best() {
  const Explanation* best = best_of(1);
  if (best == nullptr || best->log_evidence - owner_.log_evidence < rules_.doubted_gain) return;
  Explanation again{{}, continued_fit(best->fit, {}, {})};
  polish({&again}, 4);
  if (!again.fit.failed && again.log_evidence > owner_.log_evidence) owner_ = std::move(again);
}

void Search::fit_owner() {
  owner_.fit = as_configured_;
  improve(rows_, {&owner_.fit}, 5, Columns::all, settings_.settled_gain);
  if (settings_.grow_floor) {
    fit_owner_beside_slow_error();
    if (free_supply_swing()) fit_owner_beside_slow_error();
  }
  if (settings_.grow_floor) {
    as_configured_.known_columns.assign(as_configured_.parameters.size(), 0);
    linearise(rows_, {&as_configured_});
  }
  owner_.log_evidence = owner_.fit.log_evidence();
}

void Search::fit_owner_beside_slow_error() {
  for (int round = 0; round < floor_rounds; ++round) {
    rows_.take_slow_error(owner_.fit.hypothesis());
    improve(rows_, {&owner_.fit}, 4, Columns::corrected, settings_.settled_gain);
  }
}

bool Search::free_supply_swing() {
  const auto swing = strongest_supply_swing(rows_, owner_.fit.hypothesis());
  if (!swing || 0.5 * swing->share * owner_.fit.chi2() < rules_.alarm_gain) return false;
  const double spread_Pa = small_swing_share * rig_.axis.supply.pressure_Pa;
  for (int part = 0; part < static_cast<int>(rows_.model().start_factor_count()); ++part) {
    FreeParameter free;
    free.swing_part = part;
    free.spread = spread_Pa;
    nuisances_.push_back(free);
  }
  swing_Hz_ = swing->frequency_Hz;
  as_configured_ = start_fit({});
  linearise(rows_, {&as_configured_});
  owner_.fit = continued_fit(owner_.fit, {}, {});
  return true;
}

bool Search::owner_wants_more_swing() const {
  const Fit& fit = owner_.fit;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i)
    if (fit.parameters[i].swing_part >= 0 && fit.parameters[i].end_at(fit.z(static_cast<Eigen::Index>(i))) != 0)
      return true;
  return false;
}

bool Search::owner_wants_more(const Explanation& explanation) const {
  if (explanation.members.size() != 1) return false;
  const Fit &owner = owner_.fit, &own = explanation.fit;
  for (std::size_t i = 0; i < owner.parameters.size(); ++i) {
    const FreeParameter& granted = owner.parameters[i];
    const auto end = own.parameters.begin() + static_cast<std::ptrdiff_t>(own.own_count);
    if (std::none_of(own.parameters.begin(), end, [&](const FreeParameter& p) { return p.is_same(granted); })) continue;
    if (granted.is_at_far_end(owner.z(static_cast<Eigen::Index>(i)))) return true;
  }
  return false;
}

bool Search::is_bent() const { return owner_.fit.chi2() / static_cast<double>(rows_.count()) > bent_chi2_per_row; }

void Search::take_defect_at_owner() {
  rows_.model().set_working_point(owner_.fit.hypothesis());
  working_point_.clear();
  linearise(rows_, {&as_configured_});
  polish({&owner_}, 4);
  if (!settings_.grow_floor) owner_evidence_at_home_ = owner_.log_evidence;
}

double Search::beside_own_error(const Explanation& e) {
  return e.log_evidence + 0.5 * e.fit.chi2() + rows_.model().likeliest_slow_errors(e.fit.hypothesis()).log_likelihood;
}

std::vector<std::pair<double, Explanation*>> Search::beside_own_errors(std::size_t members) {
  std::vector<std::pair<double, Explanation*>> ranked;
  for (Explanation* e : all_tried(members)) ranked.emplace_back(beside_own_error(*e), e);
  std::stable_sort(ranked.rbegin(), ranked.rend(), is_behind);
  return ranked;
}

std::pair<double, Explanation*> Search::best_beside_own_error(std::size_t members) {
  std::vector<std::pair<double, Explanation*>> ranked = beside_own_errors(members);
  if (ranked.empty()) return {-1e300, nullptr};
  ranked.resize(std::min(ranked.size(), settings_.polished));
  for (auto& [evidence, explanation] : ranked) {
    rows_.take_slow_error(explanation->fit.hypothesis());
    polish({explanation}, 4, Anew::own);
    evidence = beside_own_error(*explanation);
  }
  return *std::max_element(ranked.begin(), ranked.end(), is_behind);
}

void Search::take_floor_at_best() {
  // Each name beside the slow error that it leaves itself: the owner's takes in what is missing, and beside it names
  // of other channels come forward.
  tell(0.6, "each beside the slow error that it leaves");
  const double owner = beside_own_error(owner_);
  const auto [single, first] = best_beside_own_error(1);
  if (first == nullptr) return;
  first_gain_ = single - owner;
  const Explanation* floor = first_gain_ < rules_.alarm_gain ? &owner_ : first;
  if (floor == first && rules_.most_names > 1)
    if (const Explanation* pair = pair_beside(*first, single)) floor = pair;
  // What is far behind beside the error that it leaves itself is no rival on another's floor.
  std::vector<Explanation*> again{&owner_};
  for (const std::size_t members : {1u, 2u}) {
    const auto ranked = beside_own_errors(members);
    for (const auto& [evidence, explanation] : ranked)
      if (explanation == floor || evidence >= ranked.front().first - settings_.rival_distance)
        again.push_back(explanation);
  }
  std::erase_if(tried_, [&](const auto& tried) { return std::ranges::find(again, &tried.second) == again.end(); });
  rows_.take_slow_error(floor->fit.hypothesis());
  polish(again, 2, Anew::own);
  linearise(rows_, {&as_configured_});
  polish_best(1);
  if (floor->members.size() == 2) polish_best(2);
}

const Explanation* Search::pair_beside(const Explanation& first, double first_evidence) {
  tell(0.8, "effects beside the first");
  rows_.take_slow_error(first.fit.hypothesis());
  polish({&tried_.at(first.members)}, 1, Anew::own);
  const std::vector<Screened> screened = Screening(rows_, first.fit, candidates_, others(first.members)).singles();
  refit(first.fit, first.members, worth_refitting(screened, settings_.refits));
  double promised = 0;
  for (const Explanation* e : all_tried(2)) promised = std::max(promised, beside_own_error(*e) - first_evidence);
  if (promised >= settings_.screened_share * rules_.next_gain) {
    swap_members(*best_of(2));
    const auto [evidence, pair] = best_beside_own_error(2);
    if (evidence - first_evidence >= rules_.next_gain) return pair;
  }
  std::erase_if(tried_, [](const auto& tried) { return tried.first.size() > 1; });
  return nullptr;
}

void Search::swap_members(const Explanation& best) {
  const std::vector<std::size_t> members = best.members;
  for (const std::size_t leaving : members) {
    const std::vector<std::size_t> held = without_member(members, leaving);
    if (held.empty()) continue;
    if (!tried_.count(held)) fit_part(best, held);
    Explanation& base = tried_.at(held);
    if (base.fit.failed) continue;
    bring_to_slow_error(rows_, base.fit);
    const std::vector<Screened> screened = Screening(rows_, base.fit, candidates_, others(held)).singles();
    std::vector<Screened> chosen = worth_refitting(screened, settings_.next_refits);
    for (const Screened& s : screened)  // and all that mimic the one that leaves
      if (candidates_[s.candidate].family == candidates_[leaving].family && s.gain > settings_.least_gain)
        chosen.push_back(s);
    refit(base.fit, held, chosen);
  }
}

void Search::refit_sibling_pairs(const Explanation& best) {
  // Where each member of a pair has a sibling that fits nearly as well beside the other, the truth may be both
  // siblings: no swap of one alone finds them.
  if (best.members.size() != 2) return;
  std::array<std::vector<Screened>, 2> stand_ins;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t leaving = best.members[k], held = best.members[1 - k];
    for (const std::size_t sibling : others({held})) {
      if (candidates_[sibling].family != candidates_[leaving].family) continue;
      const auto found = tried_.find(with_member({held}, sibling));
      if (found == tried_.end() || found->second.fit.failed ||
          found->second.log_evidence < best.log_evidence - settings_.rival_distance)
        continue;
      Screened here{sibling, 0, {}, {}};
      const Fit& fit = found->second.fit;
      for (const FreeParameter& parameter : candidates_[sibling].parameters)
        here.start.push_back(fit.z(fit.own_place(parameter)));
      stand_ins[k].push_back(here);
    }
  }
  std::vector<std::vector<Screened>> sets;
  for (const Screened& first : stand_ins[0])
    for (const Screened& second : stand_ins[1]) sets.push_back({first, second});
  refit(best.fit, {}, sets);  // leaves out what is known already
}

bool Search::search_next(std::size_t members) {
  const Explanation* base = best_named(members);
  if (base == nullptr) return false;
  const std::vector<Screened> screened = Screening(rows_, base->fit, candidates_, others(base->members)).singles();
  const std::vector<Screened> chosen = worth_refitting(screened, settings_.next_refits);
  const double first_gain = best_named(1)->log_evidence - owner_.log_evidence;
  const double needed = rules_.needed_beside(members, first_gain);
  // Beside a large first name the owner's parameters stand at their bounds, and derivatives there know little of where
  // they would go.
  if (chosen.empty() || 0.5 * chosen.front().gain < settings_.screened_share * needed) return false;
  refit(base->fit, base->members, chosen);
  if (members == 1) {
    std::vector<std::vector<Screened>> sets;
    sets.reserve(first_pairs_.size());
    for (const ScreenedPair& pair : first_pairs_) sets.push_back({pair.first, pair.second});
    refit(is_bent() ? as_configured_ : owner_.fit, {}, sets);
  }
  const Explanation* best = best_of(members + 1);
  const double gained = best == nullptr ? 0 : best->log_evidence - base->log_evidence;
  if (gained < needed) return false;
  swap_members(*best);
  refit_sibling_pairs(*best_of(members + 1));
  take_defect_at_best(members + 1);
  polish_best(members + 1);
  settle_in_deepest_valley(members + 1);
  const Explanation& last = *best_of(members + 1);
  for (const std::size_t leaving : last.members) fit_part(last, without_member(last.members, leaving));
  return true;
}

bool Search::is_everywhere_beside(std::size_t members) {
  const std::array<Hypothesis, 1> best{best_of(members)->fit.hypothesis()};
  ResidualModel& model = rows_.model();
  const Eigen::VectorXd residual = model.residuals(best).col(0);
  return is_everywhere(model.channels(), channel_levels(model.rows(), model.channels().size(), residual),
                       rules_.floor_level);
}

std::vector<Explanation> Search::with_one_fewer(const Explanation& other) const {
  std::vector<Explanation> out;
  for (const std::size_t leaving : other.members) {
    const std::vector<std::size_t> held = without_member(other.members, leaving);
    out.push_back({held, continued_fit(other.fit, held, {})});
  }
  return out;
}

void Search::polish_each(std::vector<Explanation>& fitted) {
  std::vector<Explanation*> moving;
  for (Explanation& explanation : fitted) moving.push_back(&explanation);
  polish(moving, 6);
}

std::vector<double> Search::gains_of_names(const Explanation& other) {
  std::vector<Explanation> fitted = with_one_fewer(other);
  fitted.insert(fitted.begin(), {other.members, continued_fit(other.fit, other.members, {})});
  polish_each(fitted);
  std::vector<double> gains;
  const bool is_owned =
      other.members.size() == 1 && candidates_[other.members.front()].kind == CandidateKind::parameter;
  const double beside = fitted.front().log_evidence,
               with_all = is_owned ? std::max(other.log_evidence, beside) : beside;
  for (std::size_t i = 1; i < fitted.size(); ++i) gains.push_back(with_all - fitted[i].log_evidence);
  return gains;
}

double Search::best_with_one_fewer(const Explanation& other) {
  std::vector<Explanation> fitted = with_one_fewer(other);
  polish_each(fitted);
  double best = -std::numeric_limits<double>::infinity();
  for (const Explanation& explanation : fitted)
    if (!explanation.fit.failed) best = std::max(best, beside_own_error(explanation));
  return best;
}

std::vector<Screened> Search::screened_at(const Explanation& other) {
  Fit here = continued_fit(other.fit, other.members, {});
  linearise(rows_, {&here});
  return Screening(rows_, here, candidates_, others(other.members), AtBound::follows).singles();
}

void Search::run() {
  search_singles();
  if (best_of(1) == nullptr || settings_.grow_floor) return;
  for (std::size_t members = 1; members < rules_.most_names; ++members) {
    // Two names that leave the pressures of both sides above their floors: a machine with a little of everything.
    if (members == 2 && is_everywhere_beside(members)) break;
    tell(0.3 + 0.3 * static_cast<double>(members), fmt::format("effects beside the first {}", members));
    if (!search_next(members)) break;
  }
}

bool Search::is_description(const Explanation& explanation) const {
  return std::any_of(explanation.members.begin(), explanation.members.end(),
                     [this](std::size_t m) { return candidates_[m].is_description; });
}

const Explanation* Search::best_named(std::size_t members) const {
  for (const Explanation* e : ranking(members))
    if (!is_description(*e)) return e;
  return nullptr;
}

const Explanation* Search::best_of(std::size_t members) const {
  const std::vector<const Explanation*> ranked = ranking(members);
  return ranked.empty() ? nullptr : ranked.front();
}

std::vector<KnownStart> Search::best_starts(std::size_t most) const {
  std::vector<KnownStart> out;
  for (const Explanation* e : ranking(1)) {
    if (out.size() == most) break;
    if (is_granted(candidates_[e->members.front()])) continue;
    const double* z = e->fit.z.data();
    out.push_back({candidates_[e->members.front()].name, {z, z + e->fit.own_count}});
  }
  return out;
}

std::vector<const Explanation*> Search::ranking(std::size_t members) const {
  std::vector<const Explanation*> out;
  if (members == 0) return {&owner_};
  for (const auto& [key, explanation] : tried_)
    if (key.size() == members && !explanation.fit.failed) out.push_back(&explanation);
  std::stable_sort(out.begin(), out.end(),
                   [](const Explanation* a, const Explanation* b) { return a->log_evidence > b->log_evidence; });
  return out;
}

}  // namespace pneuservo
