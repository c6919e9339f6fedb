// A diagnosis from code: a rig and its recordings in, what the model lacks out.
#include "diagnosis/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/input_error.hpp"
#include "config/rig_parameters.hpp"
#include "diagnosis/cylinder_residuals.hpp"
#include "diagnosis/driven_axis_residuals.hpp"
#include "diagnosis/recording_doubts.hpp"
#include "diagnosis/result_text.hpp"
#include "diagnosis/shown_candidates.hpp"
#include "diagnosis/stretches.hpp"
#include "diagnosis/stroke_residuals.hpp"
#include "diagnosis/vessel_residuals.hpp"

namespace pneuservo {

namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 1;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// A squared mismatch above what floors alone make.
double above_floor(double chi2, double floor) { return std::max(chi2 - floor, 0.0); }

void add_parameters(const Decision& decision, const Candidate& candidate, DiagnosisAnswer& answer) {
  const Explanation& chosen = *decision.chosen;
  const Eigen::MatrixXd covariance = decision.growth * chosen.fit.covariance();
  for (const FreeParameter& own : candidate.parameters)
    for (std::size_t i = 0; i < chosen.fit.own_count; ++i) {
      const FreeParameter& fitted = chosen.fit.parameters[i];
      if (fitted.path != own.path) continue;
      const auto at = static_cast<Eigen::Index>(i);
      const std::string key =
          candidate.kind == CandidateKind::parameter ? "value" : own.path.substr(own.path.rfind('.') + 1);
      answer.parameters.push_back(
          {key, fitted.value(chosen.fit.z(at)), fitted.slope(chosen.fit.z(at)) * std::sqrt(covariance(at, at))});
    }
}

void add_answers(const Decision& decision, const Search& search, const DecisionRules& rules, Diagnosis& out) {
  for (const std::size_t member : decision.chosen->members) {
    const Candidate& candidate = search.candidates()[member];
    DiagnosisAnswer answer;
    answer.effect = candidate.name;
    answer.element = candidate.element;
    answer.probability = probability_of_member(decision, search, member, rules);
    add_parameters(decision, candidate, answer);
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

/// What the patterns of each element over all channels take of what is left on the owner's model.
std::vector<ElementPattern> patterns_of_elements(ResidualModel& model, const Search& search,
                                                 const DecisionRules& rules) {
  const Hypothesis here = search.owner().fit.hypothesis();
  const ModelLevels owner = model_levels(model, here, rules);
  std::vector<Hypothesis> hypotheses;
  std::vector<std::string> elements;
  for (const Candidate& candidate : search.candidates()) {
    if (candidate.kind != CandidateKind::effect) continue;
    for (const std::vector<double>& start : candidate.starts) {
      std::vector<double> z = start;
      for (std::size_t p = 0; p < z.size(); ++p)
        if (candidate.amplitude[p])
          z[p] = std::clamp(candidate.parameters[p].z(get_parameter(here.rig, candidate.parameters[p].path)),
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

/// Where something sits that has no name: the element whose patterns over all channels take most of what is left on the
/// owner's model.
void add_unknown(ResidualModel& model, const Decision& decision, const Search& search, const DecisionRules& rules,
                 Diagnosis& out) {
  double sum = 1e-300;
  const std::vector<ElementPattern> ranked =
      out.stopped ? screened_elements(search) : patterns_of_elements(model, search, rules);
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
  answer.probability = rules.unknown_sure;
  answer.note = decision.reason;
  if (!decision.chosen->members.empty() && !decision.is_described) {
    const double before = search.owner().fit.chi2(), after = decision.chosen->fit.chi2();
    std::string names;
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

/// Share of the squared mismatch above the sensors' floors that the chosen names take, the grown floor left aside.
double plainly_explained(ResidualModel& model, const Search& search, const Decision& decision,
                         const DecisionRules& rules) {
  const ModelLevels owner = model_levels(model, search.owner().fit.hypothesis(), rules);
  double rows = 0;
  for (const ChannelLevel& c : owner.channels) rows += static_cast<double>(c.fitted_rows);
  const double all = above_floor(owner.chi2(false), rows), left = above_floor(decision.levels.chi2(false), rows);
  return all > 0 ? std::max(0.0, 1 - left / all) : 0;
}

void add_fit(ResidualModel& model, const Search& search, const Decision& decision, const DecisionRules& rules,
             Diagnosis& out) {
  const std::vector<ResidualChannel>& channels = model.channels();
  const Hypothesis before = search.as_configured().hypothesis(), after = decision.chosen->fit.hypothesis();
  const std::vector<ChannelMisfit> misfit_before = model.sample_misfit(before),
                                   misfit_after = model.sample_misfit(after);
  std::vector<double> ratios, over;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    ChannelFit fit;
    fit.column = channels[c].name + "_" + channels[c].unit;
    fit.noise = std::hypot(channels[c].noise, channels[c].floor);
    fit.before = misfit_before[c].fitted;
    fit.after = misfit_after[c].fitted;
    fit.held_out_before = misfit_before[c].held_out;
    fit.held_out_after = misfit_after[c].held_out;
    fit.correlation = decision.levels.channels[c].correlation;
    if (fit.held_out_before > 0) ratios.push_back(fit.held_out_after / fit.held_out_before);
    if (fit.noise > 0) over.push_back(fit.after / fit.noise);
    out.channels.push_back(fit);
  }
  out.held_out_ratio = median(ratios);
  out.over_noise = median(over);
  out.residual_channels = channels;
  const std::vector<Hypothesis> configured{before};
  const Eigen::VectorXd residual_before = model.residuals(configured).col(0);
  for (std::size_t i = 0; i < model.rows().size(); ++i) {
    if (model.rows()[i].over_recording) continue;
    out.rows.push_back(model.rows()[i]);
    out.residual_before.push_back(residual_before(static_cast<Eigen::Index>(i)));
    out.residual_after.push_back(decision.levels.residual(static_cast<Eigen::Index>(i)));
  }
  out.courses_before = model.courses(before);
  out.courses_after = model.courses(after);
  const double floor = std::min(decision.chosen->fit.chi2(), static_cast<double>(decision.levels.residual.size()));
  const double total = above_floor(search.owner().fit.chi2(), floor);
  out.explained_share = total > 0 ? 1 - above_floor(decision.chosen->fit.chi2(), floor) / total : 0;
  if (decision.beside_remainder) out.explained_share = plainly_explained(model, search, decision, rules);
}

/// What a size that is said to show has beyond the least, in standard errors. Nine in ten would need 1.3 were all
/// linear; with that 67 of 80 own machines showed it.
constexpr double detectable_margin = 2.0;

/// Size at which a candidate would gain what an alarm needs and be no longer negligible, nine times in ten.
void add_detectable(const Search& search, const Decision& decision, const DecisionRules& rules, Diagnosis& out) {
  for (const Screened& screened : search.first_screening()) {
    const Candidate& candidate = search.candidates()[screened.candidate];
    if (candidate.is_description) continue;
    if (std::find(decision.chosen->members.begin(), decision.chosen->members.end(), screened.candidate) !=
        decision.chosen->members.end())
      continue;
    for (std::size_t p = 0, a = 0; p < candidate.parameters.size(); ++p) {
      if (!candidate.amplitude[p]) continue;
      const FreeParameter& parameter = candidate.parameters[p];
      const double error = screened.standard_error[a++];
      if (!(error > 0)) break;
      const double occam = std::max(0.0, std::log(1 / error));
      const double size = error * (std::sqrt(2 * (rules.alarm_gain + occam)) + detectable_margin);
      const double neutral = parameter.z(candidate.neutral[p]);
      double value = parameter.value(neutral + size);
      if (parameter.variation == Variation::linear)
        value = candidate.neutral[p] + std::max(value - candidate.neutral[p],
                                                candidate.negligible[p] + detectable_margin * error * parameter.spread);
      const std::string key =
          candidate.kind == CandidateKind::parameter ? "value" : parameter.path.substr(parameter.path.rfind('.') + 1);
      out.detectable.push_back({candidate.name, key, value});
      break;  // the first amplitude is the one that names it
    }
  }
}

void add_moved(const Rig& rig, const Decision& decision, Diagnosis& out) {
  const Fit& fit = decision.chosen->fit;
  for (std::size_t i = fit.own_count; i < fit.parameters.size(); ++i) {
    const FreeParameter& parameter = fit.parameters[i];
    if (parameter.start_factor >= 0) continue;
    const double z = fit.z(static_cast<Eigen::Index>(i));
    out.moved.push_back({parameter.path, get_parameter(rig, parameter.path), parameter.value(z), z});
  }
  std::stable_sort(out.moved.begin(), out.moved.end(), [](const MovedParameter& a, const MovedParameter& b) {
    return std::abs(a.tolerances) > std::abs(b.tolerances);
  });
}

/// Of each recording by the channel with most rows, each for the usual step between them.
void add_times(const ResidualModel& model, Diagnosis& out) {
  std::map<int, std::map<int, std::vector<const ResidualRow*>>> recordings;
  for (const ResidualRow& row : model.rows())
    if (!row.over_recording) recordings[row.recording][row.channel].push_back(&row);
  for (const auto& [recording, channels] : recordings) {
    const auto most = std::max_element(channels.begin(), channels.end(),
                                       [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    std::vector<double> times_s;
    for (const ResidualRow* row : most->second) times_s.push_back(row->time_s);
    const double step_s = times_s.size() > 1 ? median_step_s(times_s) : 0.0;
    for (const ResidualRow* row : most->second) (row->held_out ? out.held_out_s : out.admitted_s) += step_s;
  }
}

/// Beside small physics the residual is not smooth, and fits creep on: by a twentieth of an alarm's gain in all.
constexpr double settled_gain_beside = 3.0;

/// The verdict on a search, with the chosen explanation fitted to its end.
Decision decided(ResidualModel& model, Search& search, const DecisionRules& rules, Diagnosis& out) {
  Decision decision = decide(model, search, rules);
  if (out.stopped) return decision;
  try {
    if (search.settle(*decision.chosen)) judge_what_is_left(model, search, rules, decision);
  } catch (const DiagnosisStopped&) {
    out.stopped = true;
    out.warnings.emplace_back("stopped early: the chosen explanation is not fitted to its end");
  }
  return decision;
}

/// Throws InputError where there is nothing to compare: no row, or no finite course of the rig as configured.
void require_comparison(const Rig& rig, FittedRows& rows) {
  ResidualModel& model = rows.model();
  if (model.rows().empty())
    throw InputError(fmt::format("{}: no row of the recordings can be compared: position or drive are missing, or the "
                                 "slider stands at an end stop throughout; expected motion with both recorded",
                                 rig.name));
  if (rows.count() == 0)
    throw InputError(fmt::format("{}: every row that can be compared is held out, expected some to fit", rig.name));
  if (!rows({Hypothesis{rig, {}}}).allFinite())
    throw InputError(
        fmt::format("{}: the rig as configured has no finite course on these recordings; expected position, "
                    "pressures and command in SI units (m, Pa absolute, V)",
                    rig.name));
}

void run_search(Search& search, Diagnosis& out) {
  try {
    search.run();
  } catch (const DiagnosisStopped&) {
    out.stopped = true;
    out.warnings.emplace_back("stopped early: names not yet tried are missing from the candidates");
    if (search.owner().fit.z.size() == 0) throw;
  }
}

/// Only the columns that are compared here: a virtual machine may record more than the real one has.
Recording with_compared_columns(Recording recording, const std::vector<ResidualChannel>& channels) {
  for (std::size_t c = recording.names.size(); c-- > 0;) {
    const std::string& name = recording.names[c];
    const bool is_input = name == "t_s" || name == "x_m" || name == "u_V" || name == "F_N";
    const bool is_compared = std::any_of(channels.begin(), channels.end(),
                                         [&](const ResidualChannel& r) { return name == r.name + "_" + r.unit; });
    if (is_input || is_compared) continue;
    recording.names.erase(recording.names.begin() + static_cast<std::ptrdiff_t>(c));
    recording.values.erase(recording.values.begin() + static_cast<std::ptrdiff_t>(c));
  }
  return recording;
}

void add_next_experiment(const Rig& rig, const ResidualModel& model, const Decision& decision, const Search& search,
                         const DiagnoseOptions& options, Diagnosis& out) {
  const bool has_rivals = out.verdict != Verdict::consistent && out.verdict != Verdict::unknown;
  if (!options.virtual_machine || !has_rivals || out.stopped) return;
  if (options.progress) options.progress(0.97, "next experiment");
  const CompareRecording compare = [&](const Recording& recording) {
    return make_residual_model(rig, {with_compared_columns(recording, model.channels())}, options.jobs);
  };
  out.next_experiment = propose_experiment(rig, decision, search, options.rules,
                                           motion_range(model.rows()).top_speed_mps, options.virtual_machine, compare);
}

/// Whether the verdict needs more than any one machine should lack: as many names as are ever sought, or more of the
/// owner's tolerances at the end of their range than any owner errs by; or whether held-out stretches speak against it.
/// Then names may stand for small physics that is everywhere.
bool is_doubtful(const Rig& rig, const Decision& decision, const DecisionRules& rules) {
  if (!rig.is_pneumatic() || decision.verdict == Verdict::consistent) return false;
  if (decision.is_shaken) return false;  // its levels are the owner's, and names would follow the shaking
  // Names that fit and do not go on: what they stand for is not what is missing.
  if (decision.verdict == Verdict::unknown && !decision.is_described &&
      decision.levels.held_out_excess() > rules.held_out_excess)
    return true;
  const Fit& fit = decision.chosen->fit;
  if (decision.chosen->members.size() >= rules.most_names) return true;
  std::size_t at_end = 0;
  for (std::size_t i = fit.own_count; i < fit.parameters.size(); ++i)
    if (rig.tolerances.count(fit.parameters[i].path) > 0 &&
        std::abs(fit.z(static_cast<Eigen::Index>(i))) >= rules.stretched_tolerance)
      ++at_end;
  return at_end >= rules.stretched_count;
}

/// Whether a decision leaves about as little as another, fitted and held-out rows together.
bool fits_as_well(const Decision& decision, const Decision& other, const DecisionRules& rules) {
  const double left = decision.levels.chi2(false) + decision.levels.chi2(true),
               others = other.levels.chi2(false) + other.levels.chi2(true);
  return left <= rules.doubted_left * others;
}

/// What the model agrees with only if it is granted: no name of its own, but nothing that goes unsaid.
void add_small_physics(const Rig& rig, const Decision& decision, Diagnosis& out) {
  const Fit& fit = decision.chosen->fit;
  std::vector<std::string> granted;
  for (std::size_t i = fit.own_count; i < fit.parameters.size(); ++i) {
    const FreeParameter& p = fit.parameters[i];
    const double z = fit.z(static_cast<Eigen::Index>(i));
    if (!p.path.empty() && rig.tolerances.count(p.path) == 0 && std::abs(z) >= 0.3)
      granted.push_back(fmt::format("{} = {:.3g}", p.path, p.value(z)));
  }
  out.warnings.push_back(
      fmt::format("the model agrees with small physics granted beside the config: {}", fmt::join(granted, ", ")));
}

/// Names of the search without small physics that the search with it refits, whatever they promise: beside an owner's
/// fit that small physics has bent, a delay of 6 ms promised less than eleven others, and it was the truth.
constexpr std::size_t carried_over = 4;

/// The search and its verdict with small physics free beside the tolerances; what that leaves is warned of.
Decision with_small_physics(const Rig& rig, FittedRows& rows, std::vector<Candidate> candidates, const Search& plain,
                            const DiagnoseOptions& options, std::optional<Search>& search, Diagnosis& out) {
  ResidualModel& model = rows.model();
  SearchSettings settings;
  SmallPhysics granted = small_physics(rig, model.channels());
  settings.small_physics = std::move(granted.parameters);
  settings.known_starts = plain.best_starts(carried_over);
  settings.grow_floor = true;
  settings.settled_gain = settled_gain_beside;
  std::erase_if(candidates, [](const Candidate& c) { return c.is_mimicked_by_small_physics; });
  DecisionRules rules = options.rules;
  rules.most_names = 1;
  search.emplace(rows, granted.rig, std::move(candidates), settings, rules, options.progress);
  run_search(*search, out);
  const Explanation* best = search->best_of(1);
  const std::vector<double> levels = model.take_slow_error((best ? *best : search->owner()).fit.hypothesis());
  model.drop_slow_error();
  for (std::size_t c = 0; c < levels.size(); ++c)
    if (levels[c] > 0)
      out.warnings.push_back(fmt::format("{}: small physics without a name leaves about {:.3g} {}",
                                         model.channels()[c].name, levels[c], model.channels()[c].unit));
  return decide_beside_remainder(model, *search, options.rules);
}

/// The rig without the disturbances that its config plays in simulation: no recording repeats their phase.
Rig without_disturbances(Rig rig, std::vector<std::string>& warnings) {
  const auto leave_out = [&](const char* effect, double& amplitude) {
    if (amplitude == 0) return;
    amplitude = 0;
    warnings.push_back(fmt::format("effects.{} of the config is left out: its phase is that of a simulation", effect));
  };
  leave_out("periodic_force", rig.axis.effects.motion.periodic_force.amplitude_N);
  leave_out("supply_swing", rig.axis.effects.supply_swing.amplitude_Pa);
  return rig;
}

}  // namespace

std::unique_ptr<ResidualModel> make_residual_model(const Rig& rig, const std::vector<Recording>& recordings, int jobs) {
  const int threads = jobs > 0 ? jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  if (rig.kind == RigKind::vessel || rig.kind == RigKind::switched_cylinder)
    for (const Recording& recording : recordings)
      if (!recording.changed.empty())
        throw InputError(fmt::format("{}: found a changed {}, expected none: recordings of a {} share one config",
                                     recording.path, recording.changed.front().first,
                                     rig_kind_names[static_cast<std::size_t>(rig.kind)]));
  if (rig.kind == RigKind::driven_axis) return std::make_unique<DrivenAxisResiduals>(rig, recordings);
  if (rig.kind == RigKind::vessel) return std::make_unique<VesselResiduals>(rig, recordings, threads);
  if (rig.kind == RigKind::switched_cylinder) return std::make_unique<StrokeResiduals>(rig, recordings, threads);
  CylinderResidualsSettings settings;
  settings.jobs = threads;
  return std::make_unique<CylinderResiduals>(rig, recordings, settings);
}

Diagnosis diagnose(const Rig& rig, ResidualModel& model, const DiagnoseOptions& options) {
  Diagnosis out;
  out.rig = rig.name;
  out.configured = rig;
  FittedRows rows(model, options.stop);
  require_comparison(rig, rows);
  const std::vector<Candidate> candidates =
      shown_candidates(all_candidates(rig, model.channels(), motion_range(model.rows())), rig, model);
  SearchSettings settings;
  Search first_search(rows, rig, candidates, settings, options.rules, options.progress);
  run_search(first_search, out);
  if (options.progress) options.progress(0.95, "verdict");
  Decision decision = decided(model, first_search, options.rules, out);
  const bool leaves_something = decision.levels.highest() > options.rules.floor_level;
  if (!rig.is_pneumatic() && !decision.is_shaken &&
      (decision.verdict == Verdict::unknown || leaves_something || !rig.has_controller()))
    decision = decide_in_one_quantity(model, first_search, options.rules);
  std::optional<Search> beside;
  const bool left_everywhere = decision.verdict == Verdict::unknown && !decision.is_described &&
                               is_everywhere(model.channels(), decision.levels.channels, options.rules.floor_level);
  if (!out.stopped && (left_everywhere || is_doubtful(rig, decision, options.rules))) {
    const std::vector<std::string> warnings = out.warnings;
    const Decision granted = with_small_physics(rig, rows, candidates, first_search, options, beside, out);
    if (left_everywhere || fits_as_well(granted, decision, options.rules)) {
      decision = granted;
    } else {  // what was doubted explains what small physics and one name do not
      beside.reset();
      out.warnings = warnings;
      model.set_working_point(decision.chosen->fit.hypothesis());
    }
  }
  const Search& search = beside ? *beside : first_search;
  out.verdict = decision.verdict;
  if (beside && out.verdict == Verdict::consistent) add_small_physics(rig, decision, out);
  add_candidates(decision, search, out);
  if (decision.verdict == Verdict::unknown) add_unknown(model, decision, search, options.rules, out);
  else if (decision.verdict != Verdict::consistent) {
    add_answers(decision, search, options.rules, out);
    add_element_shares(decision, search, out);
  }
  add_fit(model, search, decision, options.rules, out);
  if (decision.beside_remainder && out.verdict != Verdict::unknown && !out.answers.empty())
    out.answers.front().note =
        fmt::format("takes {:.0f} % of the squared mismatch; the remainder: {}", 100 * out.explained_share,
                    decision.reason.empty() ? "nothing above the floors" : decision.reason);
  add_detectable(search, decision, options.rules, out);
  add_moved(rig, decision, out);
  add_times(model, out);
  add_next_experiment(rig, model, decision, search, options, out);
  out.improved = without_empty_port_volumes(decision.chosen->fit.hypothesis().rig);
  double& overlap_V = out.improved.axis.effects.valve.valve_dead_band.width_V;
  if (overlap_V < 0) {
    out.warnings.push_back(
        fmt::format("the edges of the valve overlap by {:.3g} V (an underlap), for which a config has "
                    "no key: the improved config goes without it",
                    overlap_V));
    overlap_V = 0;
  }
  out.hypotheses_tried = rows.hypotheses_tried();
  out.sentence = verdict_sentence(out);
  return out;
}

Diagnosis diagnose(const Rig& configured, const std::vector<Recording>& recordings, const DiagnoseOptions& options) {
  if (recordings.empty()) throw InputError("diagnose: no recording, expected at least one");
  std::vector<std::string> left_out;
  const Rig rig = without_disturbances(configured, left_out);
  if (options.progress) options.progress(0.01, "recordings");
  std::vector<Recording> doubted = recordings;
  doubt_recordings(rig, doubted, left_out);
  const std::vector<Recording> stretches = compared_stretches(rig, std::move(doubted), left_out);
  const std::unique_ptr<ResidualModel> model = make_residual_model(rig, stretches, options.jobs);
  Diagnosis out = diagnose(rig, *model, options);
  out.warnings.insert(out.warnings.end(), left_out.begin(), left_out.end());
  for (const Recording& stretch : stretches) out.recordings.push_back(stretch.path);
  for (const Recording& recording : recordings) {
    for (const auto& [path, value] : recording.changed)
      out.warnings.push_back(fmt::format("{}: made with {} = {:g} instead of {:g}, and compared so", recording.path,
                                         path, value, get_parameter(rig, path)));
    for (const std::string& line : problem_lines(recording)) out.warnings.push_back(line);
  }
  return out;
}

}  // namespace pneuservo
