// How a search fits its explanations: where they start, side by side, from each other's places, to their ends.
#include <algorithm>
#include <array>
#include <set>

#include "diagnosis/residuals/command_answer.hpp"
#include "diagnosis/search/search.hpp"

namespace pneuservo {

namespace {

/// Shares of the screened size that a fit may start from; the best is taken.
constexpr std::array<double, 5> start_shares{1.0, 0.5, 0.25, 0.1, 0.02};

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

}  // namespace

Fit Search::start_fit(const std::vector<std::size_t>& members) const {
  std::vector<FreeParameter> own;
  for (const std::size_t member : members)
    own.insert(own.end(), candidates_[member].parameters.begin(), candidates_[member].parameters.end());
  Fit fit = fit_at_start(rig_, rows_, std::move(own), nuisances_);
  fit.base.swing_Hz = swing_Hz_;
  if (swing_Hz_ > 0) fit.base.swing_Pa.assign(rows_.model().start_factor_count(), 0.0);
  return fit;
}

Fit Search::continued_fit(const Fit& base, const std::vector<std::size_t>& members,
                          const std::vector<Screened>& added) const {
  Fit fit = start_fit(members);
  fit.freed_from = base.freed_from;
  for (const auto& [i, k] : shared_parameters(fit, base)) {
    fit.z(i) = base.z(k);
    fit.jacobian.col(i) = base.jacobian.col(k);
    fit.known_columns[static_cast<std::size_t>(i)] = static_cast<std::size_t>(i) >= fit.own_count;
  }
  for (const Screened& one : added) {
    const Candidate& candidate = candidates_[one.candidate];
    for (std::size_t p = 0; p < candidate.parameters.size(); ++p) {
      const FreeParameter& parameter = candidate.parameters[p];
      fit.z(fit.own_place(parameter)) = std::clamp(one.start[p], parameter.lower, parameter.upper);
    }
  }
  return fit;
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
    // What tolerances mimic while it is small has bent the fit without it: once more from the configured numbers.
    const std::vector<std::vector<double>>& whole = candidates_[added.front().candidate].whole_starts;
    if (!members.empty() || whole.empty() || &base == &as_configured_) continue;
    starts.push_back(added);
    starts.back().front().start = whole.back();
    attempts.push_back({all, continued_fit(as_configured_, all, starts.back())});
  }
  move_to_best_share(attempts, starts);
  std::vector<Fit*> fits;
  fits.reserve(attempts.size());
  for (Explanation& attempt : attempts) fits.push_back(&attempt.fit);
  improve(rows_, fits, 4, kept_columns(), settings_.settled_gain);
  for (Explanation& attempt : attempts) {
    Explanation& kept = tried_.at(attempt.members);
    if (!attempt.fit.failed) attempt.log_evidence = log_evidence(attempt);
    if (kept.fit.failed || attempt.log_evidence > kept.log_evidence) kept = std::move(attempt);
  }
}

void Search::fit_part(const Explanation& whole, const std::vector<std::size_t>& part) {
  Explanation explanation{part, continued_fit(whole.fit, part, {})};
  polish({&explanation}, 4);
  const auto known = tried_.find(part);
  if (known == tried_.end() || known->second.fit.failed || explanation.log_evidence > known->second.log_evidence)
    tried_[part] = std::move(explanation);
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
          double& size = z(fit.own_place(candidate.parameters[p]));
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

double Search::log_prior(const Explanation& explanation) const {
  double prior = 0;
  for (const std::size_t member : explanation.members) {
    if (candidates_[member].kind == CandidateKind::sensor) prior += sensor_log_prior;
    if (candidates_[member].is_guessed) prior += guessed_log_prior;
    if (candidates_[member].is_description) prior += description_log_prior;
  }
  return prior;
}

double Search::log_evidence(const Explanation& explanation) const {
  return explanation.fit.log_evidence() + log_prior(explanation);
}

void Search::polish(const std::vector<Explanation*>& explanations, int iterations, Anew anew) {
  std::vector<Fit*> fits;
  for (Explanation* explanation : explanations) {
    Fit& fit = explanation->fit;
    if (anew == Anew::own) keep_nuisance_columns(fit);
    else fit.known_columns.assign(fit.parameters.size(), 0);
    fits.push_back(&fit);
  }
  improve(rows_, fits, iterations, kept_columns(), settings_.settled_gain);
  for (Explanation* explanation : explanations)
    explanation->log_evidence = explanation->fit.failed ? -1e300 : log_evidence(*explanation);
}

double Search::evidence_scale(const Fit& fit) const {
  return rig_.is_pneumatic() ? 1.0 : std::max(1.0, fit.chi2() / static_cast<double>(rows_.count()));
}

std::vector<Explanation*> Search::rivals(std::size_t members, double distance, std::size_t most) {
  std::vector<Explanation*> out;
  for (auto& [key, explanation] : tried_)
    if (key.size() == members && !explanation.fit.failed) out.push_back(&explanation);
  std::stable_sort(out.begin(), out.end(),
                   [](const Explanation* a, const Explanation* b) { return a->log_evidence > b->log_evidence; });
  // A description takes no name its place: where two names are missing it may be far before the better of them.
  const Explanation* named = best_named(members);
  const Explanation& best = named != nullptr ? *named : out.empty() ? owner_ : *out.front();
  const double least = best.log_evidence - distance * evidence_scale(best.fit);
  std::erase_if(out, [&](const Explanation* e) { return e->log_evidence < least; });
  if (out.size() > most) out.resize(most);
  return out;
}

std::vector<Explanation*> Search::all_tried(std::size_t members) { return rivals(members, 1e300, tried_.size()); }

std::vector<Explanation*> Search::refit_at_rivals(std::size_t members) {
  const std::vector<Explanation*> close = rivals(members, settings_.rival_distance, compared_places);
  for (Explanation* e : close) bring_to_slow_error(rows_, e->fit);
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
  improve(rows_, fits, 3, kept_columns(), settings_.settled_gain);
  std::vector<Explanation*> moved;
  for (auto& [mover, fit] : attempts) {
    if (fit.failed || fit.objective >= mover->fit.objective - settings_.settled_gain) continue;
    mover->fit = std::move(fit);
    if (!std::count(moved.begin(), moved.end(), mover)) moved.push_back(mover);
  }
  polish(moved, 1);  // their derivatives are still those of where they came from
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
    polish(moving, 6);
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

bool Search::move_to_deeper_valley(std::size_t members) {
  const Explanation* best = best_of(members);
  if (best == nullptr) return false;
  std::vector<Explanation> beside;
  for (std::size_t p = 0; p < best->fit.own_count; ++p) {
    const FreeParameter& own = best->fit.parameters[p];
    const auto at = static_cast<Eigen::Index>(p);
    if (own.valleys_apart == 0) continue;
    for (const double away : {-1.0, 1.0}) {
      const double z = own.z(own.value(best->fit.z(at)) + away * own.valleys_apart);
      if (z <= own.lower || z >= own.upper) continue;
      beside.push_back(*best);
      beside.back().fit.z(at) = z;
    }
  }
  std::vector<Explanation*> moving;
  for (Explanation& e : beside) moving.push_back(&e);
  polish(moving, 6);
  const auto deepest = std::ranges::max_element(beside, {}, &Explanation::log_evidence);
  if (deepest == beside.end() || deepest->log_evidence <= best->log_evidence + settled_evidence) return false;
  tried_.at(best->members) = std::move(*deepest);
  return true;
}

void Search::settle_in_deepest_valley(std::size_t members) {
  // The grid's error, taken anew in each, may make another one the deepest.
  for (std::size_t valley = 0; valley < CommandAnswer::latest && move_to_deeper_valley(members); ++valley) {
    take_defect_at_best(members);
    polish_best(members);
  }
}

bool Search::restart_siblings() {
  const Explanation* best = best_of(1);
  if (best == nullptr || !is_one_time(best->fit)) return false;
  const auto family_of = [&](const Explanation* e) { return candidates_[e->members.front()].family; };
  std::vector<Explanation*> siblings = all_tried(1);
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
  polish(moving, 6);
  bool any_better = false;
  for (std::size_t i = 0; i < again.size(); ++i) {
    if (again[i].log_evidence <= siblings[i]->log_evidence + settled_evidence) continue;
    *siblings[i] = std::move(again[i]);
    any_better = true;
  }
  return any_better;
}

}  // namespace pneuservo
