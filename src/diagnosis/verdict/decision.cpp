// From fitted explanations to a verdict: how many effects are real, what is left over, how sure that is.
#include "diagnosis/verdict/decision.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "config/rig_parameters.hpp"
#include "diagnosis/verdict/disturbances.hpp"

namespace pneuservo {
namespace {

/// Sizes of a member's amplitudes in standard errors; the largest.
double size_in_errors(const Explanation& explanation, const Candidate& candidate) {
  const Eigen::MatrixXd covariance = explanation.fit.covariance();
  double most = 0;
  bool has_amplitude = false;
  for (std::size_t p = 0; p < candidate.parameters.size(); ++p) {
    if (!candidate.amplitude[p]) continue;
    has_amplitude = true;
    for (std::size_t i = 0; i < explanation.fit.own_count; ++i) {
      if (explanation.fit.parameters[i].path != candidate.parameters[p].path) continue;
      const auto at = static_cast<Eigen::Index>(i);
      const double neutral = candidate.parameters[p].z(candidate.neutral[p]);
      most = std::max(most, std::abs(explanation.fit.z(at) - neutral) / std::sqrt(covariance(at, at)));
    }
  }
  return has_amplitude ? most : 1e9;
}

/// Whether a member is smaller than what clock, converters and grid decide.
bool is_negligible(const Explanation& explanation, const Candidate& candidate) {
  bool judged = false;
  for (std::size_t p = 0; p < candidate.parameters.size(); ++p) {
    if (candidate.negligible[p] <= 0) continue;
    judged = true;
    const FreeParameter& parameter = candidate.parameters[p];
    for (std::size_t i = 0; i < explanation.fit.own_count; ++i) {
      if (explanation.fit.parameters[i].path != parameter.path) continue;
      const double varied = parameter.center + parameter.spread * explanation.fit.z(static_cast<Eigen::Index>(i));
      if (std::abs(varied - parameter.varied(candidate.neutral[p])) >= candidate.negligible[p]) return false;
    }
  }
  return judged;
}

/// Explanations of one size whose prediction of held-out rows is looked at.
constexpr std::size_t most_predicted = 24;

double own_value(const Explanation& explanation, const std::string& path) {
  for (std::size_t i = 0; i < explanation.fit.own_count; ++i)
    if (explanation.fit.parameters[i].path == path)
      return explanation.fit.parameters[i].value(explanation.fit.z(static_cast<Eigen::Index>(i)));
  return 0;
}

/// Whether the member is in truth the simpler law that it contains: Stribeck friction with next to no extra force, a
/// friction that hardly differs by direction.
bool is_simpler_law(const Explanation& explanation, const Candidate& candidate, double small_share) {
  if (candidate.entry == nullptr || candidate.entry->contains.name.empty()) return false;
  const SimplerLaw& simpler = candidate.entry->contains;
  const auto value = [&](std::string_view key) { return own_value(explanation, candidate.path_of(key)); };
  if (!simpler.extra.empty()) return value(simpler.extra) < small_share * value(simpler.beside);
  const double one = value(simpler.alike[0]), other = value(simpler.alike[1]);
  return std::abs(one - other) < small_share * 0.5 * (one + other);
}

std::vector<const Explanation*> sizeable(const Search& search, std::size_t members, const DecisionRules& rules) {
  std::vector<const Explanation*> out = search.ranking(members);
  std::erase_if(out, [&](const Explanation* e) {
    return std::any_of(e->members.begin(), e->members.end(), [&](std::size_t m) {
      return is_negligible(*e, search.candidates()[m]) || is_simpler_law(*e, search.candidates()[m], rules.small_share);
    });
  });
  return out;
}

/// Whether every member beyond the best smaller explanation is sure of its size.
bool is_sure_of_sizes(const Explanation& explanation, const Search& search, double standard_errors) {
  return std::all_of(explanation.members.begin(), explanation.members.end(), [&](std::size_t m) {
    return size_in_errors(explanation, search.candidates()[m]) >= standard_errors;
  });
}

Verdict verdict_of(const Explanation& chosen, const Search& search) {
  bool sensors = true, parameters = true;
  for (const std::size_t member : chosen.members) {
    sensors = sensors && search.candidates()[member].kind == CandidateKind::sensor;
    parameters = parameters && search.candidates()[member].kind == CandidateKind::parameter;
  }
  if (chosen.members.empty()) return Verdict::consistent;
  if (sensors) return Verdict::sensor_error;
  return parameters ? Verdict::parameter_error : Verdict::missing_physics;
}

}  // namespace

/// Shares of `whole` by evidence, none of which counts for more than the first one's.
std::vector<double> shares_of(const std::vector<double>& evidence, double temperature, double whole) {
  std::vector<double> out;
  double sum = 0;
  for (const double e : evidence) {
    out.push_back(std::exp(std::clamp((e - evidence.front()) / temperature, -700.0, 0.0)));
    sum += out.back();
  }
  for (double& share : out) share *= whole / sum;
  return out;
}

std::vector<double> probabilities_of(const std::vector<const Explanation*>& rivals, const DecisionRules& rules,
                                     double whole) {
  const bool is_owner = rivals.front()->members.empty();
  std::vector<double> evidence;
  for (const Explanation* rival : rivals)
    evidence.push_back(rival->log_evidence - (is_owner && !rival->members.empty() ? rules.alarm_gain : 0));
  return shares_of(evidence, rules.temperature, whole);
}

namespace {

/// An explanation by less than is ever named, where it fits better than all that is: no such name then stands for it.
/// It is named after all where the owner's model leaves more than the floors, else nothing is missing; nullptr: there
/// is none.
const Explanation* unnamed_best(const Search& search, const std::vector<const Explanation*>& ranked,
                                const DecisionRules& rules) {
  const Explanation* best = search.best_of(1);
  if (best == nullptr || !is_negligible(*best, search.candidates()[best->members.front()])) return nullptr;
  const double next = ranked.empty() ? search.owner().log_evidence : ranked.front()->log_evidence;
  return best->log_evidence > next + rules.ambiguous_distance() ? best : nullptr;
}

/// The best that is sure of its sizes: a leak that opens at any pressure is known by two numbers that follow each
/// other; nullptr: there is none.
const Explanation* first_sure(const std::vector<const Explanation*>& ranked, const Search& search,
                              const DecisionRules& rules) {
  const auto found = std::ranges::find_if(
      ranked, [&](const Explanation* e) { return is_sure_of_sizes(*e, search, rules.standard_errors); });
  return found == ranked.end() ? nullptr : *found;
}

/// The best explanation of each number of members, as long as one more brings enough.
Decision chosen_chain(ResidualModel& model, const Search& search, const DecisionRules& rules) {
  Decision decision;
  decision.chosen = &search.owner();
  std::vector<const Explanation*> ranked = sizeable(search, 1, rules);
  if (const Explanation* small = unnamed_best(search, ranked, rules)) {
    const bool is_seen = model_levels(model, search.owner().fit, rules).highest() > rules.floor_level;
    if (is_seen) ranked.insert(ranked.begin(), small);
    else ranked.clear();
  }
  double first_gain = 0;
  for (std::size_t members = 1; !ranked.empty(); ranked = sizeable(search, ++members, rules)) {
    const Explanation* best = first_sure(ranked, search, rules);
    // A first name that hardly any size is known of stands where nothing that is sure of its own comes near.
    if (members == 1 &&
        (best == nullptr || best->log_evidence < ranked.front()->log_evidence - rules.ambiguous_distance()))
      best = ranked.front();
    if (best == nullptr) break;
    const double gain = best->log_evidence - decision.chosen->log_evidence;
    if (members == 1) first_gain = gain;
    if (gain < rules.needed_beside(members - 1, first_gain)) break;
    decision.chosen = best;
    decision.rivals = ranked;
    std::erase(decision.rivals, best);
    decision.rivals.insert(decision.rivals.begin(), best);
  }
  decision.gain = decision.chosen->log_evidence - search.owner().log_evidence;
  decision.verdict = verdict_of(*decision.chosen, search);
  if (decision.chosen->members.empty()) {
    decision.rivals = sizeable(search, 1, rules);
    decision.rivals.insert(decision.rivals.begin(), decision.chosen);
  } else if (decision.chosen->members.size() > 1) {
    std::erase_if(decision.rivals,
                  [&](const Explanation* e) { return e->log_evidence > decision.chosen->log_evidence; });
  }
  decision.probabilities = probabilities_of(decision.rivals, rules, rules.most_sure);
  return decision;
}

/// The line of which two numbers would have to be off; empty: none. Each is read with a ruler, and an owner errs once:
/// with two numbers free a line stands for any volume and resistance, such as those of a branch.
std::string twice_wrong_line(const Explanation& explanation, const Search& search) {
  std::vector<std::string> wrong;
  for (const std::size_t m : explanation.members) {
    const Candidate& candidate = search.candidates()[m];
    if (candidate.kind != CandidateKind::parameter || !candidate.element.starts_with("line_")) continue;
    if (std::find(wrong.begin(), wrong.end(), candidate.element) != wrong.end()) return candidate.element;
    wrong.push_back(candidate.element);
  }
  return "";
}

/// Volume that a line would have more than its owner says [m3].
double volume_beyond(const Explanation& explanation, const Search& search, const std::string& line) {
  const auto volume = [&](const Rig& rig) {
    return bore_area_m2(get_parameter(rig, line + ".diameter_m")) * get_parameter(rig, line + ".length_m");
  };
  return volume(explanation.fit.hypothesis().rig) - volume(search.owner().fit.hypothesis().rig);
}

/// Of the squared residual that the owner's model leaves above the floors, what an explanation takes.
double share_taken(double before, double after, double rows) {
  return (before - after) / std::max(before - std::min(after, rows), 1e-300);
}

/// Whether something is left that is small beside what the names take: it is told beside them and takes no name away.
bool is_small_remainder(const Decision& decision, const Search& search, const DecisionRules& rules) {
  if (decision.reason.empty() || decision.chosen->members.empty() || decision.levels.line) return false;
  const Fit& fit = decision.chosen->fit;
  const double taken = share_taken(search.owner().fit.chi2(), fit.chi2(), static_cast<double>(fit.residual.size()));
  return taken >= rules.most_sure && decision.levels.highest() < rules.small_remainder &&
         decision.levels.highest_held_out() < rules.small_remainder;
}

/// Whether the owner's model stands clearly above the chosen one's mean square, or above one where the chosen one does
/// too. Where the floor has grown too large both are below one, and their ratio counts.
bool is_owner_refuted(const Search& search, const Decision& decision, const DecisionRules& rules) {
  const double chosen = decision.chosen->fit.chi2(), rows = static_cast<double>(decision.chosen->fit.residual.size());
  return search.owner().fit.chi2() >= rules.worse_fit * std::min(chosen, rows);
}

/// Whether names bring what stands clearly above the floors down to a remainder that they could stay beside elsewhere:
/// a constant error fades in a slow one, and the mean squares beside that hardly tell it.
bool bring_down(const Decision& decision, const ModelLevels& before, const DecisionRules& rules) {
  return before.highest() >= rules.small_remainder && decision.levels.highest() < rules.small_remainder;
}

/// What a description that explains the recordings tells: where, by which shape, how much.
std::string description_words(const Decision& decision, const Search& search) {
  const Explanation& chosen = *decision.chosen;
  const Candidate& candidate = search.candidates()[chosen.members.front()];
  std::string sizes;
  for (const FreeParameter& own : candidate.parameters)
    sizes += fmt::format("{}{} = {:.4g}", sizes.empty() ? "" : ", ", own.path.substr(own.path.rfind('.') + 1),
                         own_value(chosen, own.path));
  const double before = search.owner().fit.chi2(), after = chosen.fit.chi2();
  return fmt::format("{} describes it ({}) and takes {:.0f} % of the squared mismatch", candidate.name, sizes,
                     100 * std::max(0.0, 1 - after / std::max(before, 1e-300)));
}

/// Makes a verdict by a description `unknown` at its element, with what it tells.
void say_described(const Search& search, Decision& decision) {
  decision.is_described = !decision.chosen->members.empty() && search.is_description(*decision.chosen);
  if (!decision.is_described) return;
  decision.verdict = Verdict::unknown;
  decision.element = search.candidates()[decision.chosen->members.front()].element;
  decision.reason =
      description_words(decision, search) + (decision.reason.empty() ? "" : "; beside it ") + decision.reason;
}

/// The best description, where it leaves about as little as names that leave something: two names that together
/// follow a bent curve are not what is missing.
const Explanation* as_good_description(const Search& search, const Decision& decision, const DecisionRules& rules) {
  if (decision.reason.empty() || decision.chosen->members.empty() || search.is_description(*decision.chosen))
    return nullptr;
  for (const Explanation* e : search.ranking(1))
    if (search.is_description(*e) && e->log_evidence >= search.owner().log_evidence + rules.alarm_gain)
      return e->fit.chi2() <= rules.worse_fit * decision.chosen->fit.chi2() ? e : nullptr;
  return nullptr;
}

}  // namespace

Decision decide(ResidualModel& model, const Search& search, const DecisionRules& rules) {
  Decision decision = chosen_chain(model, search, rules);
  judge_what_is_left(model, search, rules, decision);
  const Explanation* description =
      decision.chosen->members.size() > 1 ? as_good_description(search, decision, rules) : nullptr;
  if (description == nullptr) return decision;
  Decision described = decide_on(*description, model, search, rules);
  return described.is_described ? described : decision;
}

Decision decide_on(const Explanation& chosen, ResidualModel& model, const Search& search, const DecisionRules& rules) {
  Decision decision;
  decision.chosen = &chosen;
  decision.rivals = search.ranking(chosen.members.size());
  std::erase_if(decision.rivals, [&](const Explanation* e) { return e->log_evidence >= chosen.log_evidence; });
  decision.rivals.insert(decision.rivals.begin(), &chosen);
  decision.gain = chosen.log_evidence - search.owner().log_evidence;
  judge_what_is_left(model, search, rules, decision);
  return decision;
}

void judge_what_is_left(ResidualModel& model, const Search& search, const DecisionRules& rules, Decision& decision) {
  decision.is_shaken = decision.is_described = false;
  decision.levels = model_levels(model, decision.chosen->fit, rules);
  decision.reason = what_is_left(decision, model, rules);
  decision.beside_remainder = is_small_remainder(decision, search, rules);
  const bool is_named = decision.reason.empty() || decision.beside_remainder;
  decision.verdict = is_named ? verdict_of(*decision.chosen, search) : Verdict::unknown;
  decision.element = twice_wrong_line(*decision.chosen, search);
  if (!decision.element.empty()) {
    decision.verdict = Verdict::unknown;
    decision.reason +=
        fmt::format("{}two numbers of {} would both have to be wrong: it holds {:+.3g} cm3 of gas beside "
                    "what its owner says, as a branch or a vessel on it would",
                    decision.reason.empty() ? "" : "; ", decision.element,
                    1e6 * volume_beyond(*decision.chosen, search, decision.element));
  }
  if (is_named) say_described(search, decision);
  else if (decision.element.empty() && model.simulates() && find_shaking(model, search, rules, decision)) return;
  decision.probabilities =
      probabilities_of(decision.rivals, rules, decision.beside_remainder ? rules.most_sure_beside : rules.most_sure);
}

namespace {

/// Whether the owner's model has this name's number at the end of what is granted, and the name is sure of its size.
bool is_wanted(const Explanation& name, const Search& search, const DecisionRules& rules) {
  return search.owner_wants_more(name) && is_sure_of_sizes(name, search, rules.standard_errors);
}

/// Whether a name whose number stands at the end of what is granted is clearly likelier than the owner's model. A
/// number that its owner states needs less than what nobody states, which has to bring what any first name does.
bool is_clearly_wanted(const Explanation& name, const Search& search, const DecisionRules& rules) {
  const bool is_stated = search.candidates()[name.members.front()].kind == CandidateKind::parameter;
  const double needed = is_stated ? rules.ambiguous_distance() : rules.alarm_gain;
  return name.log_evidence - search.owner().log_evidence >= needed && is_wanted(name, search, rules);
}

/// Where small physics brings all to its floor, but with a number at the end of what its owner states or of what every
/// machine is granted: that number is off if setting it free is clearly likelier, and no other name is clearly likelier
/// still. nullopt: none is.
std::optional<Decision> number_beyond_granted(ResidualModel& model, const Search& search, const DecisionRules& rules) {
  std::vector<const Explanation*> ranked = sizeable(search, 1, rules);
  const auto off =
      std::ranges::find_if(ranked, [&](const Explanation* e) { return is_clearly_wanted(*e, search, rules); });
  if (off == ranked.end() || ranked.front()->log_evidence - (*off)->log_evidence > rules.ambiguous_distance())
    return std::nullopt;
  Decision decision;
  decision.chosen = *off;
  decision.gain = decision.chosen->log_evidence - search.owner().log_evidence;
  decision.beside_remainder = true;
  std::rotate(ranked.begin(), off, off + 1);
  decision.rivals = std::move(ranked);
  decision.probabilities = probabilities_of(decision.rivals, rules, rules.most_sure_beside);
  decision.verdict = verdict_of(*decision.chosen, search);
  decision.levels = model_levels(model, decision.chosen->fit, rules);
  return decision;
}

/// Whether more of the owner's tolerances stand at the end of their range than any owner errs by: three of a dozen
/// numbers beyond three of their spreads come once in 200 000 machines.
bool errs_too_often(const Explanation& explanation, const DecisionRules& rules) {
  return tolerances_at_end(explanation.fit.base.rig, explanation.fit) >= rules.most_names;
}

}  // namespace

Decision decide_beside_remainder(ResidualModel& model, const Search& search, const DecisionRules& rules) {
  Decision decision = chosen_chain(model, search, rules);
  decision.beside_remainder = true;
  decision.probabilities = probabilities_of(decision.rivals, rules, rules.most_sure_beside);
  decision.levels = model_levels(model, decision.chosen->fit, rules);
  const ModelLevels before = model_levels(model, search.owner().fit, rules);
  decision.reason = what_is_left(decision, model, rules);
  const double share = share_taken(before.chi2(false), decision.levels.chi2(false),
                                   static_cast<double>(search.owner().fit.residual.size()));
  const bool is_named = !decision.chosen->members.empty() && search.first_gain() >= rules.alarm_gain &&
                        (is_owner_refuted(search, decision, rules) || bring_down(decision, before, rules) ||
                         (errs_too_often(search.owner(), rules) && !errs_too_often(*decision.chosen, rules))) &&
                        share >= rules.taken_share;
  const double taken = is_named ? 1 - decision.levels.chi2(false) / before.chi2(false) : 0;
  if (find_supply_swing(model, search, rules, taken, decision)) return decision;
  if (!is_named && find_shaking(model, search, rules, decision)) return decision;
  const bool is_periodic = find_periodic_force(model, rules, rules.taken_share, decision);
  if (!is_periodic && is_named) {
    say_described(search, decision);
    return decision;
  }
  decision.verdict = Verdict::unknown;
  Decision owners;
  owners.chosen = &search.owner();
  owners.levels = before;
  owners.reason = what_is_left(owners, model, rules);
  if (!is_periodic && owners.reason.empty()) {  // small physics alone brings all to its floor
    if (const auto off = number_beyond_granted(model, search, rules)) return *off;
    if (!errs_too_often(search.owner(), rules)) return owners;
    decision.reason = "all is at its floor, but only with as many tolerances at their ends as no owner errs by";
  }
  if (decision.reason.empty()) decision.reason = owners.reason;  // the best name takes it, and is not to be given
  return decision;
}

namespace {

/// Squared residual of an explanation above what floors alone make, on fitted and held-out rows.
double above_floors(ResidualModel& model, const Explanation& explanation, const DecisionRules& rules) {
  const ModelLevels levels = model_levels(model, explanation.fit, rules);
  double rows = 0;
  for (const ChannelLevel& c : levels.channels) rows += static_cast<double>(c.fitted_rows + c.held_out_rows);
  return std::max(levels.chi2(false) + levels.chi2(true) - rows, 0.0);
}

/// How sure each law is of what it has beyond a simpler one, in standard errors beside a floor that has grown by this.
double certainty_of_law(const Explanation& explanation, const Search& search, double growth) {
  const Eigen::MatrixXd covariance = growth * explanation.fit.covariance();
  double least = 1e300;
  for (const std::size_t m : explanation.members)
    for (const FreeParameter& own : search.candidates()[m].parameters) {
      if (own.path != search.candidates()[m].extra()) continue;
      const auto at = static_cast<Eigen::Index>(explanation.fit.own_place(own));
      least = std::min(least, (explanation.fit.z(at) - own.z(0)) / std::sqrt(covariance(at, at)));
    }
  return least;
}

/// Whether `richer` is the other explanation with a law in place of the simpler one that it contains.
bool holds_law_of(const Explanation& richer, const Explanation& other, const Search& search) {
  std::vector<std::size_t> own = richer.members, others = other.members;
  std::erase_if(own, [&](std::size_t m) { return contains(other.members, m); });
  std::erase_if(others, [&](std::size_t m) { return contains(richer.members, m); });
  if (own.size() != 1 || others.size() != 1) return false;
  const Candidate &law = search.candidates()[own.front()], &simpler = search.candidates()[others.front()];
  return !law.extra().empty() && simpler.extra().empty() && law.family == simpler.family;
}

/// Whether a size stands at the end of its range away from nothing: then physics would have to give more than it can.
bool stands_at_its_end(const Explanation& explanation, const Search& search) {
  for (const std::size_t m : explanation.members) {
    const Candidate& candidate = search.candidates()[m];
    for (std::size_t p = 0; p < candidate.parameters.size(); ++p) {
      const FreeParameter& own = candidate.parameters[p];
      if (!candidate.amplitude[p] || candidate.kind == CandidateKind::parameter) continue;
      const int end = own.end_at(explanation.fit.z(explanation.fit.own_place(own)));
      if (end != 0 && end != own.end_at(own.z(candidate.neutral[p]))) return true;
    }
  }
  return false;
}

/// What no floor changes: how likely the names are before any data. A size that cannot be negative has half the values
/// of one that can, each twice as likely: on an axis that is pulled one way friction opposes by its nature, a constant
/// force by chance.
double prior_of_names(const Explanation& explanation, const Search& search) {
  double prior = search.log_prior(explanation);
  for (const std::size_t m : explanation.members) {
    const Candidate& candidate = search.candidates()[m];
    for (std::size_t p = 0; p < candidate.parameters.size(); ++p)
      if (candidate.amplitude[p] && candidate.kind == CandidateKind::effect &&
          candidate.parameters[p].lower >= candidate.parameters[p].z(candidate.neutral[p]))
        prior += std::numbers::ln2;
  }
  return prior;
}

struct Foretold {
  double score;
  const Explanation* explanation;
  double certainty;  ///< of its laws
};
using Ranked = std::vector<Foretold>::const_iterator;
/// The explanations of one size by evidence, with what they foretell of the held-out rows counted in: a law that fits
/// but does not go on is behind its rivals.
std::vector<Foretold> by_prediction(ResidualModel& model, const Search& search, std::size_t members, double growth,
                                    const DecisionRules& rules) {
  std::vector<Foretold> out;
  const std::vector<const Explanation*> ranked = sizeable(search, members, rules);
  for (const Explanation* e : ranked) {
    if (out.size() >= most_predicted) break;
    const double certainty = certainty_of_law(*e, search, growth);
    if (certainty < rules.told_errors || stands_at_its_end(*e, search)) continue;
    const double foretold = model_levels(model, e->fit, rules).chi2(true);
    const double by_data = e->log_evidence - search.log_prior(*e) - 0.5 * foretold;
    out.push_back({by_data / growth + prior_of_names(*e, search), e, certainty});
  }
  std::stable_sort(out.begin(), out.end(), [](const Foretold& a, const Foretold& b) { return a.score > b.score; });
  return out;
}

/// Rows that are worth one: those over which the model's error stays the same, and what a remainder makes of them by
/// its mean square in floors and how long neighbours stay alike.
double floor_growth(const ModelLevels& levels, const std::vector<ResidualRow>& rows) {
  double growth = 1;
  for (const ResidualRow& row : rows) growth = std::max(growth, row.alike_rows);
  for (const ChannelLevel& c : levels.channels) {
    const double alike = std::clamp(c.correlation, 0.0, 0.99);
    growth = std::max(growth, c.fitted * c.fitted * (1 + alike) / (1 - alike));
  }
  return growth;
}

std::string periodic_part(const Decision& decision, const ResidualModel& model) {
  for (std::size_t c = 0; c < model.channels().size(); ++c)
    if (const auto period = strongest_period(model.rows(), decision.levels.residual, static_cast<int>(c)))
      return fmt::format("; {:.0f} % of it is periodic along the way with {:.3g} mm ({:.2g} {})", 100 * period->share,
                         1e3 * period->period_m, period->amplitude, model.channels()[c].unit);
  return "";
}

/// Of the explanations from `best` on the one that stands: one with more numbers stands for one with fewer only where
/// that one leaves clearly more. A number that the owner may have wrong goes before physics that the config has not,
/// where what it leaves beyond that is a small share of `all`.
template <class IsSure>
Ranked plain_enough(ResidualModel& model, const Search& search, Ranked best, Ranked end, const IsSure& is_sure,
                    double all, const DecisionRules& rules) {
  double leaves = best == end ? 0 : above_floors(model, *best->explanation, rules);
  for (auto plainer = best; plainer != end; ++plainer) {
    if (plainer->explanation->fit.own_count >= best->explanation->fit.own_count || !is_sure(*plainer)) continue;
    const double plainer_leaves = above_floors(model, *plainer->explanation, rules);
    const bool is_owned =
        std::all_of(plainer->explanation->members.begin(), plainer->explanation->members.end(),
                    [&](std::size_t m) { return search.candidates()[m].kind == CandidateKind::parameter; });
    const bool is_about_alike = is_owned && plainer_leaves - leaves < rules.small_share * all;
    if (plainer_leaves >= rules.worse_fit * leaves && !is_about_alike) continue;
    best = plainer;
    leaves = plainer_leaves;
  }
  return best;
}

/// Takes the rivals from `best` on, or all, then the too rich laws before it, which the rows do not exclude.
std::vector<double> scores_of_rivals(Decision& decision, const Search& search, Ranked first, Ranked best, Ranked end) {
  std::vector<double> scores;
  decision.rivals.clear();
  for (auto r = best != end ? best : first; r != end; ++r)
    decision.rivals.push_back(r->explanation), scores.push_back(r->score);
  for (auto r = first; best != end && r != best; ++r)
    if (holds_law_of(*r->explanation, *best->explanation, search))
      decision.rivals.push_back(r->explanation), scores.push_back(best->score);
  return scores;
}

}  // namespace

Decision decide_in_one_quantity(ResidualModel& model, const Search& search, const DecisionRules& rules) {
  Decision decision;
  decision.chosen = &search.owner();
  decision.beside_remainder = true;
  const Explanation* richest = &search.owner();
  for (std::size_t members = 1; search.best_of(members) != nullptr; ++members) richest = search.best_of(members);
  const double growth = decision.growth = floor_growth(model_levels(model, richest->fit, rules), model.rows());
  const double all = above_floors(model, search.owner(), rules);
  std::vector<double> scores;
  double left = all, score = by_prediction(model, search, 0, growth, rules).front().score;
  for (std::size_t members = 1;; ++members) {
    const auto ranked = by_prediction(model, search, members, growth, rules);
    // What is clearly missed may have a wide size (a bent law: heat that nearly keeps the wall's temperature), but one.
    const auto is_sure = [&](const Foretold& r) {
      const double gain = (r.explanation->log_evidence - decision.chosen->log_evidence) / growth;
      const double errors = gain >= rules.alarm_gain ? rules.told_errors : rules.standard_errors;
      const bool is_sized = members == 1 || is_sure_of_sizes(*r.explanation, search, errors * std::sqrt(growth));
      return is_sized && r.certainty >= rules.standard_errors;
    };
    const auto best = plain_enough(model, search, std::find_if(ranked.begin(), ranked.end(), is_sure), ranked.end(),
                                   is_sure, all, rules);
    const double leaves = best == ranked.end() ? left : above_floors(model, *best->explanation, rules);
    // What is left counts as noise already (growth): one more name is asked for no more evidence than the first.
    const bool enough = best != ranked.end() && best->score - score >= rules.alarm_gain &&
                        (members == 1 || left >= rules.worse_fit * leaves);
    if (members == 1 || enough)
      scores = scores_of_rivals(decision, search, ranked.begin(), enough ? best : ranked.end(), ranked.end());
    if (!enough) break;
    decision.chosen = best->explanation;
    left = leaves;
    score = best->score;
  }
  decision.probabilities = shares_of(scores, rules.temperature, rules.most_sure_beside);
  decision.gain = (decision.chosen->log_evidence - search.owner().log_evidence) / growth;
  decision.verdict = verdict_of(*decision.chosen, search);
  decision.levels = model_levels(model, decision.chosen->fit, rules);
  decision.reason = fmt::format("{}; {:.2g} % of the squared mismatch{}", what_is_left(decision, model, rules),
                                100 * left / std::max(all, 1e-300), periodic_part(decision, model));
  const bool at_floor = decision.levels.highest() <= rules.floor_level && !decision.levels.line;
  if (decision.chosen->members.empty() ? !at_floor : all - left < rules.taken_share * all)
    decision.verdict = Verdict::unknown;
  else say_described(search, decision);
  return decision;
}

}  // namespace pneuservo
