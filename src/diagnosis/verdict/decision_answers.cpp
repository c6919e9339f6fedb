// What a decision says of elements and names: answers, shares, rivals, and where an unknown sits.
#include "diagnosis/verdict/decision_answers.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "config/rig_parameters.hpp"

namespace pneuservo {

namespace {

/// What variances are multiplied by: rows that the fit leaves above their floors tell as much less (Birge's ratio).
double variance_growth(const Decision& decision) {
  double rows = 0;
  for (const ChannelLevel& channel : decision.levels.channels) rows += static_cast<double>(channel.fitted_rows);
  return rows > 0 ? std::max(decision.growth, decision.levels.chi2(false) / rows) : decision.growth;
}

/// Of all explanations that say the same as this member of the chosen one, less what small unmodelled physics may gain.
double probability_of_member(const Decision& decision, const Search& search, std::size_t member,
                             const DecisionRules& rules) {
  double sum = 0;
  for (std::size_t i = 0; i < decision.rivals.size(); ++i)
    if (contains(decision.rivals[i]->members, member)) sum += decision.probabilities[i];
  // What the member gains where it is beside all others; with each name that is there already, small physics has more
  // to hide behind.
  double without = decision.chosen->members.size() == 1 ? search.owner().log_evidence : -1e300;
  for (const Explanation* smaller : search.ranking(decision.chosen->members.size() - 1))
    if (std::find(smaller->members.begin(), smaller->members.end(), member) == smaller->members.end())
      without = std::max(without, smaller->log_evidence);
  const double gain = std::max(0.0, decision.chosen->log_evidence - without) / decision.growth;
  const auto names = static_cast<double>(decision.chosen->members.size());
  return sum * gain / (gain + rules.doubted_gain * names * names);
}

/// Names that cannot be told from the chosen explanation's member.
std::vector<std::string> ambiguous_names(const Decision& decision, const Search& search, std::size_t member,
                                         const DecisionRules& rules) {
  std::vector<std::string> names;
  for (const Explanation* rival : decision.rivals) {
    const double behind = (decision.chosen->log_evidence - rival->log_evidence) / decision.growth;
    if (rival == decision.chosen || behind > rules.ambiguous_distance()) continue;
    std::vector<std::size_t> other = rival->members;
    for (const std::size_t m : without_member(decision.chosen->members, member)) std::erase(other, m);
    if (other.size() == 1) names.push_back(search.candidates()[other.front()].name);
  }
  return names;
}

/// A fit stops on its bounds, but for roundings.
bool is_at_bound(const FreeParameter& fitted, double z, double neutral) {
  const auto ends_at = [&](double bound) {
    return std::fabs(z - bound) < 1e-6 && std::fabs(fitted.z(neutral) - bound) > 1e-6;
  };
  return ends_at(fitted.lower) || ends_at(fitted.upper);
}

/// How far commands that no row holds may move the numbers of the chosen explanation, in z, root mean square; zero
/// where rows hold all.
Eigen::VectorXd moved_by_unseen_commands(ResidualModel& model, const Fit& fit) {
  const Eigen::MatrixXd draws = model.unseen_commands(fit.hypothesis());
  if (draws.size() == 0) return Eigen::VectorXd::Zero(fit.z.size());
  Eigen::MatrixXd unseen = FittedRows(model, {}).of(draws);
  if (fit.freed_from) fit.freed_from->take_out(unseen);
  const Eigen::MatrixXd moved = fit.covariance() * (fit.jacobian.transpose() * unseen);  // of each draw
  return moved.rowwise().squaredNorm().cwiseSqrt() / std::sqrt(static_cast<double>(moved.cols()));
}

/// `moved`: by what no row holds, in z; empty: none.
void add_parameters(const Decision& decision, const Candidate& candidate, const Eigen::VectorXd& moved,
                    DiagnosisAnswer& answer) {
  const Explanation& chosen = *decision.chosen;
  const Eigen::MatrixXd covariance = variance_growth(decision) * chosen.fit.covariance();
  for (const FreeParameter& own : candidate.parameters)
    for (std::size_t i = 0; i < chosen.fit.own_count; ++i) {
      const FreeParameter& fitted = chosen.fit.parameters[i];
      if (fitted.path != own.path) continue;
      const auto at = static_cast<Eigen::Index>(i);
      const std::string key =
          candidate.kind == CandidateKind::parameter ? "value" : own.path.substr(own.path.rfind('.') + 1);
      const double z = chosen.fit.z(at);
      const std::size_t number = static_cast<std::size_t>(&own - candidate.parameters.data());
      // A sample of the gas tells which command acts by then; since when, within its period, only as far as a grid
      // does not smear it: evenly distributed over a period.
      const double between = fitted.valleys_apart / std::sqrt(12.0) / fitted.slope(z);
      const double error = std::hypot(std::sqrt(covariance(at, at)), moved.size() > 0 ? moved(at) : 0.0, between);
      answer.parameters.push_back(
          {key, fitted.value(z), fitted.slope(z) * error, is_at_bound(fitted, z, candidate.neutral[number])});
    }
}

/// What the patterns of each element over all channels take of what is left on the owner's model.
std::vector<ElementPattern> patterns_of_elements(ResidualModel& model, const Search& search,
                                                 const DecisionRules& rules) {
  const Hypothesis here = search.owner().fit.hypothesis();
  const ModelLevels owner = model_levels(model, search.owner().fit, rules);
  std::vector<Hypothesis> hypotheses;
  std::vector<std::string> elements;
  for (const Candidate& candidate : search.candidates()) {
    if (candidate.kind != CandidateKind::effect) continue;
    for (const std::vector<double>& start : candidate.starts) {
      std::vector<double> z = start;
      for (std::size_t p = 0; p < z.size(); ++p)
        if (candidate.amplitude[p])
          z[p] = std::clamp(candidate.parameters[p].z(candidate.parameters[p].value_in(here.rig)),
                            candidate.parameters[p].lower, candidate.parameters[p].upper) +
                 0.05;
      hypotheses.push_back(with_parameters(here, candidate.parameters, z));
      elements.push_back(candidate.element);
    }
  }
  Eigen::MatrixXd patterns = model.residuals(hypotheses);
  patterns.colwise() -= owner.residual;
  for (Eigen::Index c = 0; c < patterns.cols(); ++c)
    if (!patterns.col(c).allFinite()) patterns.col(c).setZero();
  return element_patterns(model.rows(), owner.residual, patterns, elements);
}

/// The same by what the screening says that each name would gain: for those who asked to stop.
std::vector<ElementPattern> screened_elements(const Search& search) {
  std::map<std::string, double> gains;
  for (const Screened& s : search.first_screening()) {
    double& gain = gains[search.candidates()[s.candidate].element];
    gain = std::max(gain, s.gain);
  }
  std::vector<ElementPattern> out;
  for (const auto& [element, gain] : gains) out.push_back({element, gain});
  std::stable_sort(out.begin(), out.end(),
                   [](const ElementPattern& a, const ElementPattern& b) { return a.explained > b.explained; });
  return out;
}

}  // namespace

std::string what_is_left(const Decision& decision, ResidualModel& model, const DecisionRules& rules) {
  std::string out;
  const auto say = [&](const std::string& what) { out += (out.empty() ? "" : "; ") + what; };
  for (std::size_t c = 0; c < decision.levels.channels.size(); ++c)
    if (decision.levels.channels[c].beyond_stated() > rules.floor_level)
      say(fmt::format("{} is at {:.2g} times its floor", model.channels()[c].name, decision.levels.channels[c].fitted));
  if (decision.levels.line)
    say(fmt::format("a periodic part of {:.2g} {} at {:.2f} Hz in {}", decision.levels.line->amplitude,
                    model.channels()[static_cast<std::size_t>(decision.levels.line->channel)].unit,
                    decision.levels.line->frequency_Hz,
                    model.channels()[static_cast<std::size_t>(decision.levels.line->channel)].name));
  if (decision.levels.held_out_excess() > rules.worse_fit)
    say(fmt::format("held-out stretches fit {:.2g} times worse than fitted ones", decision.levels.held_out_excess()));
  return out;
}

void add_answers(ResidualModel& model, const Decision& decision, const Search& search, const DecisionRules& rules,
                 Diagnosis& out) {
  const Eigen::VectorXd moved = moved_by_unseen_commands(model, decision.chosen->fit);
  for (const std::size_t member : decision.chosen->members) {
    const Candidate& candidate = search.candidates()[member];
    DiagnosisAnswer answer;
    answer.effect = candidate.name;
    answer.element = candidate.element;
    answer.probability = probability_of_member(decision, search, member, rules);
    add_parameters(decision, candidate, moved, answer);
    answer.ambiguous_with = ambiguous_names(decision, search, member, rules);
    // What leaving it out would cost, of all that the explanation takes.
    double without = search.owner().fit.chi2();
    for (const Explanation* smaller : search.ranking(decision.chosen->members.size() - 1))
      if (std::find(smaller->members.begin(), smaller->members.end(), member) == smaller->members.end() &&
          std::includes(decision.chosen->members.begin(), decision.chosen->members.end(), smaller->members.begin(),
                        smaller->members.end()))
        without = std::min(without, smaller->fit.chi2());
    const double taken = std::max(search.owner().fit.chi2() - decision.chosen->fit.chi2(), 1e-9);
    answer.share = std::clamp((without - decision.chosen->fit.chi2()) / taken, 0.0, 1.0);
    out.answers.push_back(answer);
  }
  std::stable_sort(out.answers.begin(), out.answers.end(),
                   [](const DiagnosisAnswer& a, const DiagnosisAnswer& b) { return a.share > b.share; });
}

void add_element_shares(const Decision& decision, const Search& search, Diagnosis& out) {
  std::map<std::string, double> shares;
  for (std::size_t i = 0; i < decision.rivals.size(); ++i)
    for (const std::size_t member : decision.rivals[i]->members) {
      const Candidate& candidate = search.candidates()[member];
      double weight = 1.0 / static_cast<double>(decision.rivals[i]->members.size());
      for (const DiagnosisAnswer& answer : out.answers)  // of two at once, by what each takes
        if (answer.effect == candidate.name && out.answers.size() > 1) weight = answer.share;
      shares[candidate.element] += weight * decision.probabilities[i];
    }
  double sum = 1e-300;
  for (const auto& [element, share] : shares) sum += share;
  for (const auto& [element, share] : shares)
    if (share / sum > 0.005) out.elements.push_back({element, share / sum});
  std::stable_sort(out.elements.begin(), out.elements.end(),
                   [](const ElementShare& a, const ElementShare& b) { return a.share > b.share; });
}

void add_unknown(ResidualModel& model, const Decision& decision, const Search& search, const DecisionRules& rules,
                 const std::vector<ElementShare>& located, Diagnosis& out) {
  double sum = 1e-300;
  std::vector<ElementPattern> ranked;
  for (const ElementShare& e : located) ranked.push_back({e.element, e.share});
  if (ranked.empty()) ranked = out.stopped ? screened_elements(search) : patterns_of_elements(model, search, rules);
  std::vector<ElementPattern> patterns_by_element = ranked;
  std::string element = decision.element;
  if (decision.levels.line && element.empty()) {  // a periodic part in the force or the supply sits there
    const std::string& channel = model.channels()[static_cast<std::size_t>(decision.levels.line->channel)].name;
    element = channel == "F" ? "motion" : channel == "p_supply" ? "supply" : "";
  }
  if (!element.empty()) {
    std::stable_partition(patterns_by_element.begin(), patterns_by_element.end(),
                          [&](const ElementPattern& e) { return e.element == element; });
    if (!patterns_by_element.empty() && patterns_by_element.front().element == element)
      patterns_by_element.front().explained = std::max(ranked.front().explained * 1.01, 1e-9);
  }
  for (const ElementPattern& e : patterns_by_element) sum += e.explained;
  for (const ElementPattern& e : patterns_by_element) out.elements.push_back({e.element, e.explained / sum});
  DiagnosisAnswer answer;
  answer.effect = "unknown";
  answer.element = out.elements.empty() ? "motion" : out.elements.front().element;
  answer.probability = rules.most_sure_beside;
  answer.note = decision.reason;
  if (!decision.chosen->members.empty() && !decision.is_described) {
    const double before = search.owner().fit.chi2(), after = decision.chosen->fit.chi2();
    std::string names;
    for (const std::size_t m : decision.chosen->members) {
      out.unsaid.emplace_back().effect = search.candidates()[m].name;
      add_parameters(decision, search.candidates()[m], {}, out.unsaid.back());
    }
    for (const std::size_t m : decision.chosen->members)
      names += (names.empty() ? "" : " and ") + search.candidates()[m].name;
    answer.note += fmt::format("; the best name, {}, takes {:.0f} % of the squared mismatch", names,
                               100 * std::max(0.0, 1 - after / std::max(before, 1e-300)));
  }
  out.answers = {answer};
}

void add_candidates(const Decision& decision, const Search& search, Diagnosis& out) {
  for (std::size_t i = 0; i < decision.rivals.size() && i < 12; ++i) {
    RankedExplanation ranked;
    for (const std::size_t m : decision.rivals[i]->members) ranked.effects.push_back(search.candidates()[m].name);
    ranked.probability = decision.probabilities[i];
    ranked.log_evidence_behind =
        std::max(0.0, (decision.rivals.front()->log_evidence - decision.rivals[i]->log_evidence) / decision.growth);
    out.candidates.push_back(ranked);
  }
}

}  // namespace pneuservo
