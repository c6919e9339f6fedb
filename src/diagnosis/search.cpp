// The search for what explains a mismatch: screening by derivatives, refits side by side, pairs with swaps, more.
#include "diagnosis/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "diagnosis/left_over.hpp"

namespace pneuservo {

namespace {

/// A fit further than this from the floor (chi2 per row) has been bent by what is missing: screen from where the owner
/// stands instead.
constexpr double bent_chi2_per_row = 3;
/// Shares of the screened size that a fit may start from; the best is taken.
constexpr std::array<double, 5> start_shares{1.0, 0.5, 0.25, 0.1, 0.02};

/// How often the floor and the owner's fit follow each other: then neither moves any more.
constexpr int floor_rounds = 2;

/// Rivals that are fitted from each other's places.
constexpr std::size_t compared_places = 8;

/// A fit that gains less than this in log evidence by fresh derivatives is at its end.
constexpr double settled_evidence = 0.3;

/// Where a sensor's fault and a physical effect are the same model, the physical one is the likelier.
constexpr double sensor_log_prior = -1;
/// An owner who gives a tolerance has looked: where a size far outside it and physics that nobody has looked for are
/// the same model, the physics is the likelier.
constexpr double guessed_log_prior = -2;
/// A shape that fits anything of its element has to be clearly better than every law.
constexpr double description_log_prior = -10;

/// Whether an explanation's size is a single time.
bool is_one_time(const Fit& fit) { return fit.own_count == 1 && fit.parameters.front().path.ends_with("_s"); }

bool same_parameter(const FreeParameter& a, const FreeParameter& b) {
  return a.start_factor == b.start_factor && a.path == b.path;
}

bool same_prior(const FreeParameter& a, const FreeParameter& b) {
  return a.spread == b.spread && a.lower == b.lower && a.upper == b.upper;
}

/// Places of the parameters that two fits have in common, with one unit and one range: a name frees wider what is a
/// nuisance elsewhere.
std::vector<std::pair<Eigen::Index, Eigen::Index>> shared_parameters(const Fit& a, const Fit& b) {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> out;
  for (std::size_t i = 0; i < a.parameters.size(); ++i)
    for (std::size_t k = 0; k < b.parameters.size(); ++k)
      if (same_parameter(a.parameters[i], b.parameters[k]) && same_prior(a.parameters[i], b.parameters[k]))
        out.emplace_back(i, k);
  return out;
}

/// Where a parameter of one of the fit's names stands among the fit's own.
Eigen::Index own_place(const Fit& fit, const FreeParameter& parameter) {
  for (std::size_t i = 0; i < fit.own_count; ++i)
    if (same_parameter(fit.parameters[i], parameter)) return static_cast<Eigen::Index>(i);
  throw std::logic_error("a fit has no parameter " + parameter.path + " of its own");
}

/// Derivatives by nuisances are kept as they are, those by the explanation's own parameters are to be taken anew.
void keep_nuisance_columns(Fit& fit) {
  for (std::size_t i = 0; i < fit.known_columns.size(); ++i) fit.known_columns[i] = i >= fit.own_count;
}

/// What is to be refitted, and the same with each member's second start in place of its first, where that promises
/// enough.
std::vector<std::vector<Screened>> with_second_starts(const std::vector<Screened>& added, double least_gain) {
  std::vector<std::vector<Screened>> out{added};
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (added[i].second_start.empty() || added[i].second_gain < least_gain) continue;
    out.push_back(added);
    out.back()[i].start = added[i].second_start;
  }
  return out;
}

std::vector<std::size_t> with_member(std::vector<std::size_t> members, std::size_t added) {
  members.insert(std::upper_bound(members.begin(), members.end(), added), added);
  return members;
}

bool contains(const std::vector<std::size_t>& members, std::size_t index) {
  return std::find(members.begin(), members.end(), index) != members.end();
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
  if (progress_) progress_(share, what);
}

Fit Search::start_fit(const std::vector<std::size_t>& members) const {
  Fit fit;
  fit.base.rig = rig_;
  fit.base.start_factors.assign(rows_.model().start_factor_count(), 0.0);
  for (const std::size_t member : members)
    for (const FreeParameter& parameter : candidates_[member].parameters) fit.parameters.push_back(parameter);
  fit.own_count = fit.parameters.size();
  for (const FreeParameter& nuisance : nuisances_)
    if (std::none_of(fit.parameters.begin(), fit.parameters.end(),
                     [&](const FreeParameter& p) { return same_parameter(p, nuisance); }))
      fit.parameters.push_back(nuisance);
  fit.z.setZero(static_cast<Eigen::Index>(fit.parameters.size()));
  fit.jacobian.setZero(rows_.count(), fit.z.size());
  fit.known_columns.assign(fit.parameters.size(), 0);
  return fit;
}

Fit Search::continued_fit(const Fit& base, const std::vector<std::size_t>& members,
                          const std::vector<Screened>& added) const {
  Fit fit = start_fit(members);
  for (const auto& [i, k] : shared_parameters(fit, base)) {
    fit.z(i) = base.z(k);
    fit.jacobian.col(i) = base.jacobian.col(k);
    fit.known_columns[static_cast<std::size_t>(i)] = static_cast<std::size_t>(i) >= fit.own_count;
  }
  for (const Screened& one : added) {
    const Candidate& candidate = candidates_[one.candidate];
    for (std::size_t p = 0; p < candidate.parameters.size(); ++p) {
      const FreeParameter& parameter = candidate.parameters[p];
      fit.z(own_place(fit, parameter)) = std::clamp(one.start[p], parameter.lower, parameter.upper);
    }
  }
  return fit;
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

void Search::refit(const Fit& base, const std::vector<std::size_t>& members, const std::vector<Screened>& chosen) {
  std::vector<std::vector<Screened>> sets;
  sets.reserve(chosen.size());
  for (const Screened& one : chosen) sets.push_back({one});
  refit(base, members, sets);
}

void Search::refit(const Fit& base, const std::vector<std::size_t>& members,
                   const std::vector<std::vector<Screened>>& sets) {
  std::vector<Explanation> attempts;
  std::vector<std::vector<Screened>> starts;
  for (const std::vector<Screened>& added : sets) {
    std::vector<std::size_t> all = members;
    for (const Screened& one : added)
      if (!contains(all, one.candidate)) all = with_member(all, one.candidate);
    if (all.size() != members.size() + added.size() || tried_.count(all)) continue;
    tried_[all].fit.failed = true;  // until an attempt has come to an end
    for (std::vector<Screened>& start : with_second_starts(added, settings_.least_gain)) {
      attempts.push_back({all, continued_fit(base, all, start)});
      starts.push_back(std::move(start));
    }
    // A vessel has few numbers, and a fit without the name may have bent them all: once more from the configured ones.
    const std::vector<std::vector<double>>& whole = candidates_[added.front().candidate].whole_starts;
    if (rig_.is_pneumatic() || !members.empty() || whole.empty() || &base == &as_configured_) continue;
    starts.push_back(added);
    starts.back().front().start = whole.back();
    attempts.push_back({all, continued_fit(as_configured_, all, starts.back())});
  }
  move_to_best_share(attempts, starts);
  std::vector<Fit*> fits;
  fits.reserve(attempts.size());
  for (Explanation& attempt : attempts) fits.push_back(&attempt.fit);
  improve(rows_, fits, 4, Columns::own, settings_.settled_gain);
  for (Explanation& attempt : attempts) {
    Explanation& kept = tried_.at(attempt.members);
    if (!attempt.fit.failed) attempt.log_evidence = log_evidence(attempt);
    if (kept.fit.failed || attempt.log_evidence > kept.log_evidence) kept = std::move(attempt);
  }
}

void Search::move_to_best_share(std::vector<Explanation>& attempts, const std::vector<std::vector<Screened>>& starts) {
  std::vector<Eigen::VectorXd> places;
  std::vector<Hypothesis> hypotheses;
  for (std::size_t f = 0; f < attempts.size(); ++f) {
    const Fit& fit = attempts[f].fit;
    for (const double share : start_shares) {
      Eigen::VectorXd z = fit.z;
      for (const Screened& one : starts[f]) {
        const Candidate& candidate = candidates_[one.candidate];
        for (std::size_t p = 0; p < candidate.parameters.size(); ++p) {
          if (!candidate.amplitude[p]) continue;
          const double neutral = candidate.parameters[p].z(candidate.neutral[p]);
          double& size = z(own_place(fit, candidate.parameters[p]));
          size = neutral + share * (size - neutral);
        }
      }
      hypotheses.push_back(with_parameters(fit.base, fit.parameters, {z.data(), z.data() + z.size()}));
      places.push_back(std::move(z));
    }
  }
  const Eigen::MatrixXd columns = rows_(hypotheses);
  for (std::size_t f = 0; f < attempts.size(); ++f) {
    double least = 1e300;
    for (std::size_t at = f * start_shares.size(); at < (f + 1) * start_shares.size(); ++at) {
      const auto column = columns.col(static_cast<Eigen::Index>(at));
      const double objective = column.squaredNorm() + places[at].squaredNorm();
      if (!column.allFinite() || objective >= least) continue;
      least = objective;
      attempts[f].fit.z = places[at];
    }
    attempts[f].fit.failed = least == 1e300;
  }
}

double Search::log_evidence(const Explanation& explanation) const {
  double prior = 0;
  for (const std::size_t member : explanation.members) {
    if (candidates_[member].kind == CandidateKind::sensor) prior += sensor_log_prior;
    if (candidates_[member].is_guessed) prior += guessed_log_prior;
    if (candidates_[member].is_description) prior += description_log_prior;
  }
  return explanation.fit.log_evidence() + prior;
}

void Search::polish(const std::vector<Explanation*>& explanations, int iterations, bool all_columns) {
  std::vector<Fit*> fits;
  for (Explanation* explanation : explanations) {
    Fit& fit = explanation->fit;
    if (all_columns) fit.known_columns.assign(fit.parameters.size(), 0);
    else keep_nuisance_columns(fit);
    fits.push_back(&fit);
  }
  improve(rows_, fits, iterations, all_columns ? Columns::all : Columns::own, settings_.settled_gain);
  for (Explanation* explanation : explanations)
    explanation->log_evidence = explanation->fit.failed ? -1e300 : log_evidence(*explanation);
}

std::vector<Explanation*> Search::rivals(std::size_t members, double distance, std::size_t most) {
  std::vector<Explanation*> out;
  for (auto& [key, explanation] : tried_)
    if (key.size() == members && !explanation.fit.failed) out.push_back(&explanation);
  std::stable_sort(out.begin(), out.end(),
                   [](const Explanation* a, const Explanation* b) { return a->log_evidence > b->log_evidence; });
  // A description takes no name its place: where two names are missing it may be far before the better of them.
  const Explanation* named = best_named(members);
  const double least = (named != nullptr ? named : out.empty() ? &owner_ : out.front())->log_evidence - distance;
  std::erase_if(out, [&](const Explanation* e) { return e->log_evidence < least; });
  if (out.size() > most) out.resize(most);
  return out;
}

std::vector<Explanation*> Search::refit_at_rivals(std::size_t members) {
  const std::vector<Explanation*> close = rivals(members, settings_.rival_distance, compared_places);
  std::vector<std::pair<Explanation*, Fit>> attempts;
  const auto attempt = [&](Explanation* mover, const Fit& other) {
    Fit fit = mover->fit;
    for (const auto& [i, k] : shared_parameters(fit, other)) {
      fit.z(i) = other.z(k);
      fit.jacobian.col(i) = other.jacobian.col(k);
    }
    keep_nuisance_columns(fit);
    attempts.emplace_back(mover, std::move(fit));
  };
  for (std::size_t i = 1; i < close.size(); ++i) {
    attempt(close[i], close[0]->fit);
    attempt(close[0], close[i]->fit);
  }
  std::vector<Fit*> fits;
  fits.reserve(attempts.size());
  for (auto& [mover, fit] : attempts) fits.push_back(&fit);
  improve(rows_, fits, 3, Columns::own, settings_.settled_gain);
  std::vector<Explanation*> moved;
  for (auto& [mover, fit] : attempts) {
    if (fit.failed || fit.objective >= mover->fit.objective - settings_.settled_gain) continue;
    mover->fit = std::move(fit);
    if (!std::count(moved.begin(), moved.end(), mover)) moved.push_back(mover);
  }
  polish(moved, 1, true);  // their derivatives are still those of where they came from
  return moved;
}

void Search::polish_rivals(std::size_t members, std::set<const Explanation*>& at_end) {
  // Until nothing moves: a large effect bends the derivatives of everything else on its way.
  for (int round = 0; round < 6; ++round) {
    std::vector<Explanation*> moving = rivals(members, settings_.rival_distance, settings_.polished);
    std::erase_if(moving, [&](const Explanation* e) { return at_end.count(e) > 0; });
    if (moving.empty()) return;
    std::vector<double> before;
    before.reserve(moving.size());
    for (const Explanation* e : moving) before.push_back(e->log_evidence);
    polish(moving, 6, true);
    for (std::size_t i = 0; i < moving.size(); ++i)
      if (moving[i]->fit.settled || moving[i]->log_evidence - before[i] < settled_evidence) at_end.insert(moving[i]);
  }
}

void Search::polish_best(std::size_t members) {
  std::set<const Explanation*> at_end;
  polish_rivals(members, at_end);
  // Not before: a fit under way would leave the valley that it is about to enter.
  const std::vector<Explanation*> moved = refit_at_rivals(members);
  for (const Explanation* e : moved) at_end.erase(e);
  if (!moved.empty()) polish_rivals(members, at_end);
}

bool Search::restart_siblings() {
  const Explanation* best = best_of(1);
  if (best == nullptr || !is_one_time(best->fit)) return false;
  const auto family_of = [&](const Explanation* e) { return candidates_[e->members.front()].family; };
  std::vector<Explanation*> siblings = rivals(1, 1e300, tried_.size());
  std::erase_if(siblings,
                [&](const Explanation* e) { return !is_one_time(e->fit) || family_of(e) != family_of(best); });
  if (siblings.size() < 2) return false;
  std::vector<Explanation> again;
  for (const Explanation* e : siblings) {
    const Fit& from = (e == siblings[0] ? siblings[1] : siblings[0])->fit;
    again.push_back({e->members, continued_fit(from, e->members, {})});
    Fit& fit = again.back().fit;
    const FreeParameter& own = fit.parameters.front();
    fit.z(0) = std::clamp(own.z(from.parameters.front().value(from.z(0))), own.lower, own.upper);
  }
  std::vector<Explanation*> moving;
  for (Explanation& e : again) moving.push_back(&e);
  polish(moving, 6, true);
  bool any_better = false;
  for (std::size_t i = 0; i < again.size(); ++i) {
    if (again[i].log_evidence <= siblings[i]->log_evidence + settled_evidence) continue;
    *siblings[i] = std::move(again[i]);
    any_better = true;
  }
  return any_better;
}

void Search::take_defect_at_best(std::size_t members) {
  const Explanation* best = best_of(members);
  if (best == nullptr || best->log_evidence - owner_.log_evidence < rules_.grid_error_gain) return;
  // Fitted to its end there first, and once more at the error that it has there: a fit that moves on leaves an error.
  for (int round = 0; round < 2; ++round) {
    polish({&tried_.at(best->members)}, 6, true);
    rows_.model().set_working_point(best->fit.hypothesis());
  }
  working_point_ = best->members;
  std::vector<Explanation*> again = rivals(members, settings_.rival_distance, 12);
  if (members > 1)
    for (Explanation* e : rivals(members - 1, settings_.rival_distance, 2)) again.push_back(e);
  again.push_back(&owner_);
  polish(again, 2, false);
  owner_.log_evidence = std::max(owner_.log_evidence, owner_evidence_at_home_);
  linearise(rows_, {&as_configured_});
}

bool Search::settle(const Explanation& explanation) {
  if (explanation.members == working_point_) return false;
  Explanation& own = explanation.members.empty() ? owner_ : tried_.at(explanation.members);
  rows_.model().set_working_point(own.fit.hypothesis());
  working_point_ = own.members;
  polish({&own}, 6, true);
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
  tell(0.05, "owner's model");
  as_configured_ = start_fit({});
  linearise(rows_, {&as_configured_});
  if (as_configured_.failed) throw std::runtime_error("the rig as configured cannot be simulated on these recordings");
  fit_owner();
  tell(0.15, "screening of all names");
  const bool bent = is_bent() && !settings_.grow_floor;
  if (!bent) take_defect_at_owner();
  const Fit& base = bent ? as_configured_ : owner_.fit;
  const Screening screening(rows_, base, candidates_, others({}));
  first_screening_ = screening.singles();
  first_pairs_ = screening.best_pairs(settings_.pairs);
  tell(0.25, "refits");
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
  take_defect_at_best(1);
  polish_best(1);
  // A name that has come forward since brings its relatives: a lag was the best without its dead time being tried.
  const std::size_t known = tried_.size();
  add_families(base, {}, first_screening_);
  add_families(owner_.fit, {}, beside_fit);
  if (tried_.size() > known) polish_best(1);
  if (restart_siblings()) polish_best(1);
  if (const Explanation* best = best_of(1)) first_gain_ = best->log_evidence - owner_.log_evidence;
  if (settings_.grow_floor) take_floor_at_best();
}

void Search::fit_owner() {
  owner_.fit = as_configured_;
  improve(rows_, {&owner_.fit}, 5, Columns::all, settings_.settled_gain);
  for (int round = 0; settings_.grow_floor && round < floor_rounds; ++round) {
    rows_.model().take_slow_error(owner_.fit.hypothesis());
    owner_.fit.known_columns.assign(owner_.fit.parameters.size(), 0);
    improve(rows_, {&owner_.fit}, 4, Columns::all, settings_.settled_gain);
  }
  if (settings_.grow_floor) {
    as_configured_.known_columns.assign(as_configured_.parameters.size(), 0);
    linearise(rows_, {&as_configured_});
  }
  owner_.log_evidence = owner_.fit.log_evidence();
}

bool Search::is_bent() const { return owner_.fit.chi2() / static_cast<double>(rows_.count()) > bent_chi2_per_row; }

void Search::take_defect_at_owner() {
  rows_.model().set_working_point(owner_.fit.hypothesis());
  working_point_.clear();
  linearise(rows_, {&as_configured_});
  polish({&owner_}, 4, true);
  if (!settings_.grow_floor) owner_evidence_at_home_ = owner_.log_evidence;
}

void Search::take_floor_at_best() {
  const Explanation* best = best_of(1);
  if (best == nullptr || first_gain_ < rules_.next_gain) return;
  rows_.model().take_slow_error(best->fit.hypothesis());
  std::vector<Explanation*> again = rivals(1, 1e300, tried_.size());
  again.push_back(&owner_);
  polish(again, 2, true);
  linearise(rows_, {&as_configured_});
  polish_best(1);
}

void Search::swap_members(const Explanation& best) {
  const std::vector<std::size_t> members = best.members;
  for (const std::size_t leaving : members) {
    std::vector<std::size_t> held = members;
    std::erase(held, leaving);
    if (held.empty()) continue;
    if (!tried_.count(held)) {
      Explanation explanation{held, start_fit(held)};
      for (const auto& [i, k] : shared_parameters(explanation.fit, best.fit)) explanation.fit.z(i) = best.fit.z(k);
      polish({&explanation}, 4, true);
      tried_[held] = std::move(explanation);
    }
    const Explanation& base = tried_.at(held);
    if (base.fit.failed) continue;
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
        here.start.push_back(fit.z(own_place(fit, parameter)));
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
  const double share = members == 1 ? rules_.next_share : std::max(rules_.next_share, rules_.third_share);
  const double needed = std::max(rules_.next_gain, share * first_gain);
  // Beside a large first name the owner's parameters stand at their bounds, and derivatives there know little of where
  // they would go.
  if (chosen.empty() || 0.5 * chosen.front().gain < rules_.screened_share * needed) return false;
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
  return true;
}

bool Search::is_everywhere_beside(std::size_t members) {
  const std::array<Hypothesis, 1> best{best_of(members)->fit.hypothesis()};
  ResidualModel& model = rows_.model();
  const Eigen::VectorXd residual = model.residuals(best).col(0);
  return is_everywhere(model.channels(), channel_levels(model.rows(), model.channels().size(), residual),
                       rules_.floor_level);
}

void Search::run() {
  search_singles();
  if (best_of(1) == nullptr) return;
  for (std::size_t members = 1; members < rules_.most_names; ++members) {
    // Two names that leave the pressures of both sides above their floors: a machine with a little of everything.
    if (members == 2 && is_everywhere_beside(members)) break;
    tell(0.4 + 0.2 * static_cast<double>(members), fmt::format("effects beside the first {}", members));
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
    if (candidates_[e->members.front()].is_mimicked_by_small_physics) continue;
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
