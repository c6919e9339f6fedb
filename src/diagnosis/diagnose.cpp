// A diagnosis from code: a rig and its recordings in, what the model lacks out.
#include "diagnosis/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/input_error.hpp"
#include "config/rig_parameters.hpp"
#include "diagnosis/doubts/recording_doubts.hpp"
#include "diagnosis/latent/latent_judgement.hpp"
#include "diagnosis/latent/latent_picture.hpp"
#include "diagnosis/latent/unknown_curve.hpp"
#include "diagnosis/recordings/recorded_rigs.hpp"
#include "diagnosis/recordings/stretches.hpp"
#include "diagnosis/recordings/telling_pieces.hpp"
#include "diagnosis/residuals/cylinder_residuals.hpp"
#include "diagnosis/residuals/driven_axis_residuals.hpp"
#include "diagnosis/residuals/known_rows.hpp"
#include "diagnosis/residuals/stroke_residuals.hpp"
#include "diagnosis/residuals/vessel_residuals.hpp"
#include "diagnosis/result_text.hpp"
#include "diagnosis/search/shown_candidates.hpp"
#include "diagnosis/verdict/decision_answers.hpp"
#include "diagnosis/verdict/two_searches.hpp"

namespace pneuservo {

namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 1;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// Of the channels together in their floors, each with the weight of its rows.
double rms_in_floors(const Diagnosis& diagnosis, const std::vector<double>& rows, double ChannelFit::* misfit) {
  double sum = 0, count = 0;
  for (std::size_t c = 0; c < rows.size(); ++c) {
    if (!(rows[c] > 0) || !(diagnosis.channels[c].noise > 0)) continue;
    sum += rows[c] * std::pow(diagnosis.channels[c].*misfit / diagnosis.channels[c].noise, 2);
    count += rows[c];
  }
  return count > 0 ? std::sqrt(sum / count) : std::numeric_limits<double>::quiet_NaN();
}

/// A squared mismatch above what floors alone make.
double above_floor(double chi2, double floor) { return std::max(chi2 - floor, 0.0); }

/// Share of the squared mismatch above the sensors' floors that the chosen names take, the grown floor left aside.
double plainly_explained(ResidualModel& model, const Search& search, const Decision& decision,
                         const DecisionRules& rules) {
  const ModelLevels owner = model_levels(model, search.owner().fit, rules);
  double rows = 0;
  for (const ChannelLevel& c : owner.channels) rows += static_cast<double>(c.fitted_rows);
  const double all = above_floor(owner.chi2(false), rows), left = above_floor(decision.levels.chi2(false), rows);
  return all > 0 ? std::max(0.0, 1 - left / all) : 0;
}

void add_fit(ResidualModel& model, const Search& search, const Decision& decision, const DecisionRules& rules,
             Diagnosis& out) {
  const std::vector<ResidualChannel>& channels = model.channels();
  const Fit &before = search.as_configured(), &after = decision.chosen->fit;
  const std::vector<ChannelMisfit> misfit_before = misfit_at(model, before), misfit_after = misfit_at(model, after);
  const std::vector<double> floors = floors_of_misfit(model);
  std::vector<double> ratios, over, fitted_rows(channels.size()), held_out_rows(channels.size());
  for (const ResidualRow& row : model.rows())
    if (!row.over_recording) ++(row.held_out ? held_out_rows : fitted_rows)[static_cast<std::size_t>(row.channel)];
  for (std::size_t c = 0; c < channels.size(); ++c) {
    ChannelFit fit;
    fit.column = channels[c].column();
    fit.noise = floors[c];
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
  out.error_left = rms_in_floors(out, held_out_rows, &ChannelFit::held_out_after) /
                   rms_in_floors(out, held_out_rows, &ChannelFit::held_out_before);
  out.floors_left = rms_in_floors(out, fitted_rows, &ChannelFit::after);
  out.residual_channels = channels;
  const Eigen::VectorXd residual_before = residual_at(model, before);
  for (std::size_t i = 0; i < model.rows().size(); ++i) {
    if (model.rows()[i].over_recording) continue;
    out.rows.push_back(model.rows()[i]);
    out.residual_before.push_back(residual_before(static_cast<Eigen::Index>(i)));
    out.residual_after.push_back(decision.levels.residual(static_cast<Eigen::Index>(i)));
  }
  out.courses_before = courses_at(model, before);
  out.courses_after = courses_at(model, after);
  const double floor = std::min(decision.chosen->fit.chi2(), static_cast<double>(decision.levels.residual.size()));
  const double total = above_floor(search.owner().fit.chi2(), floor);
  out.explained_share = total > 0 ? 1 - above_floor(decision.chosen->fit.chi2(), floor) / total : 0;
  if (decision.beside_remainder) out.explained_share = plainly_explained(model, search, decision, rules);
}

/// What a size that is said to show has beyond the least, in standard errors. Nine in ten would need 1.3 were all
/// linear; with that 67 of 80 own machines showed it.
constexpr double detectable_margin = 2.0;

/// Size at which a candidate would gain what an alarm needs and be no longer negligible, nine times in ten.
void add_detectable(const Search& search, const std::vector<Screened>& screening, const Decision& decision,
                    const DecisionRules& rules, Diagnosis& out) {
  for (const Screened& screened : screening) {
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
    if (parameter.is_of_recording()) continue;
    const double z = fit.z(static_cast<Eigen::Index>(i));
    out.moved.push_back({parameter.path, parameter.value_in(rig), parameter.value(z), z, parameter.is_at_far_end(z)});
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

/// Only the columns that are compared here: a virtual machine may record more than the real one has.
Recording with_compared_columns(Recording recording, const std::vector<ResidualChannel>& channels) {
  recording.keep_columns([&](const std::string& name) {
    const bool is_input = name == "t_s" || name == "x_m" || name == "F_N" || name.starts_with("u");
    return is_input ||
           std::any_of(channels.begin(), channels.end(), [&](const ResidualChannel& r) { return name == r.column(); });
  });
  return recording;
}

void add_next_experiment(const Rig& rig, const ResidualModel& model, const Decision& decision, const Search& search,
                         const DiagnoseOptions& options, Diagnosis& out) {
  const bool has_rivals = out.verdict != Verdict::consistent && out.verdict != Verdict::unknown;
  if (!options.virtual_machine || !has_rivals || out.stopped) return;
  if (options.progress) options.progress(0.97, "next experiment");
  const CompareRecording compare = [&](const Recording& recording) {
    return make_residual_model(rig, {with_compared_columns(recording, model.channels())}, options.jobs, options.stop);
  };
  try {
    out.next_experiment =
        propose_experiment(rig, decision, search, options.rules, motion_range(model.rows()).top_speed_mps,
                           options.virtual_machine, compare, options.stop);
  } catch (const DiagnosisStopped&) {  // the verdict stands
    out.warnings.emplace_back("stopped early: the verdict is complete, a next experiment was not chosen");
  }
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
  const Hypothesis found = fit.hypothesis();
  double swing_Pa = 0;
  for (std::size_t i = 0; i < found.swing_Pa.size(); i += 2)
    swing_Pa = std::max(swing_Pa, std::hypot(found.swing_Pa[i], found.swing_Pa[i + 1]));
  if (swing_Pa > 0)
    granted.push_back(fmt::format("a supply that swings by up to {:.2g} Pa at {:.3g} Hz", swing_Pa, found.swing_Hz));
  out.warnings.push_back(
      fmt::format("the model agrees with small physics granted beside the config: {}", fmt::join(granted, ", ")));
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

/// While it lives the model may be stopped in the midst of a run.
class StopWhileAlive {
 public:
  StopWhileAlive(ResidualModel& model, const StopQuestion& stop) : model_(model) { model_.set_stop(stop); }
  ~StopWhileAlive() { model_.set_stop({}); }
  StopWhileAlive(const StopWhileAlive&) = delete;
  StopWhileAlive& operator=(const StopWhileAlive&) = delete;

 private:
  ResidualModel& model_;
};

Diagnosis empty_diagnosis(const Rig& rig) {
  Diagnosis out;
  out.rig = rig.name;
  out.configured = rig;
  return out;
}

/// Takes the verdict from names that are clearly behind a free function.
void take_refuted_names(const LatentJudgement& judgement, const Search& search, const DecisionRules& rules,
                        Decision& decision) {
  if (decision.verdict == Verdict::unknown || !judgement.refutes_names(decision.chosen->members.size(), rules)) return;
  std::vector<std::string> names;
  for (const std::size_t m : decision.chosen->members) names.push_back(search.candidates()[m].name);
  decision.verdict = Verdict::unknown;
  decision.reason =
      fmt::format("{} and a free function of time at {}: {:+.0f} in log evidence between them, and {:.0f} that the "
                  "{} to it",
                  fmt::join(names, " and "), judgement.owner.inputs.front().input.element, judgement.names_ahead,
                  judgement.names_bring, names.size() > 1 ? "names add" : "name adds");
}

/// What free functions say, and of an unknown its picture; the courses are there already.
void add_functions(const ResidualModel& model, const LatentJudgement& judgement, Diagnosis& out) {
  if (!judgement.is_there()) return;
  out.functions = functions_of(judgement.owner);
  if (judgement.named) out.names_ahead = judgement.names_ahead, out.names_bring = judgement.names_bring;
  if (out.verdict != Verdict::unknown || out.answers.empty()) return;
  const std::vector<RankedLatent>& inputs = judgement.owner.inputs;
  const auto here = std::find_if(inputs.begin(), inputs.end(), [&](const RankedLatent& latent) {
    return latent.input.element == out.answers.front().element;
  });
  if (here == inputs.end() || !(here->fit.level > 0)) return;
  out.picture = picture_of(model.rows(), judgement.owner, *here, model.channels(), out.courses_before);
  out.answers.front().note = out.picture->words + "; " + out.answers.front().note;
}

/// A quantity that differs from the config's, within what its owner states.
void add_stated(const ResidualModel& model, const Decision& decision, const DecisionRules& rules, Diagnosis& out) {
  for (std::size_t c = 0; c < decision.levels.channels.size(); ++c) {
    const ChannelLevel& level = decision.levels.channels[c];
    const ResidualChannel& channel = model.channels()[c];
    if (level.fitted <= rules.floor_level || level.beyond_stated() > rules.floor_level) continue;
    out.warnings.push_back(
        fmt::format("{}: changes by {:.3g} {} that no name explains, within the {:.3g} {} of its tolerance",
                    channel.name, level.fitted * level.sigma, channel.unit, channel.stated, channel.unit));
  }
}

/// What stands for an unknown, or of a driven axis for what its names leave, where that was asked for; the improved
/// config has it.
void add_curve(const Rig& rig, ResidualModel& model, const Decision& decision, const Search& search,
               const DiagnoseOptions& options, Diagnosis& out) {
  if (!options.with_curve || out.verdict == Verdict::consistent || out.stopped || out.answers.empty()) return;
  const bool is_unknown = out.verdict == Verdict::unknown;
  if (!is_unknown && (rig.kind != RigKind::driven_axis || decision.levels.highest() <= options.rules.floor_level))
    return;
  if (options.progress) options.progress(0.98, "curve of what no name explains");
  const std::string element = is_unknown ? out.answers.front().element : "motion";
  const CurvePlace where{element, is_unknown ? &search.owner() : decision.chosen, options.is_whole};
  try {
    out.curve = curve_of_unknown(rig, model, search, where, options.rules, options.stop);
  } catch (const DiagnosisStopped&) {  // the verdict stands
    out.warnings.emplace_back("stopped early: the verdict is complete, a curve was not fitted");
    return;
  }
  if (out.curve) out.improved = out.curve->improved;
  else
    out.warnings.push_back(
        fmt::format("no table stands for what is missing at {}: --as-curve knows forces over "
                    "position, speed and time, leaks over pressure and a valve's areas over its "
                    "command, and none is {:g} in log evidence ahead and leaves less of what is held out",
                    element_words(element), options.rules.alarm_gain));
}

/// Everything that a decision and its search say.
void tell(const Rig& rig, ResidualModel& model, const Decision& decision, const LatentJudgement& judgement,
          const Search& search, const std::vector<Screened>& screening, const DiagnoseOptions& options,
          Diagnosis& out) {
  out.verdict = decision.verdict;
  if (search.grants_small_physics() && out.verdict == Verdict::consistent) add_small_physics(rig, decision, out);
  add_candidates(decision, search, out);
  if (decision.verdict == Verdict::unknown)
    add_unknown(model, decision, search, options.rules,
                element_probabilities(judgement.owner, options.rules.temperature), out);
  else if (decision.verdict != Verdict::consistent) {
    add_answers(model, decision, search, options.rules, out);
    add_element_shares(decision, search, out);
  }
  add_fit(model, search, decision, options.rules, out);
  add_functions(model, judgement, out);
  add_stated(model, decision, options.rules, out);
  if (decision.beside_remainder && out.verdict != Verdict::unknown && !out.answers.empty())
    out.answers.front().note =
        fmt::format("takes {:.0f} % of the squared mismatch; the remainder: {}", 100 * out.explained_share,
                    decision.reason.empty() ? "nothing above the floors" : decision.reason);
  add_detectable(search, screening, decision, options.rules, out);
  add_moved(rig, decision, out);
  add_times(model, out);
  add_next_experiment(rig, model, decision, search, options, out);
  out.improved = decision.chosen->fit.hypothesis().rig;
  add_curve(rig, model, decision, search, options, out);
  out.sentence = verdict_sentence(out);
}

/// What is to be told of recordings as they were read. Throws InputError for a change of what the rig does not have.
std::vector<std::string> told_of(const Rig& rig, const std::vector<Recording>& recordings) {
  std::vector<std::string> out;
  for (const Recording& recording : recordings) {
    machine_changes(rig, recording);
    for (const auto& [path, value] : recording.changed)
      out.push_back(fmt::format("{}: made with {} = {:g} instead of {:g}, and compared so", recording.path, path, value,
                                get_parameter(rig, path)));
    for (const std::string& line : problem_lines(recording)) out.push_back(line);
  }
  return out;
}

/// The motion, and of a vessel the pressure at which its recordings begin.
MotionRange range_of(const Rig& rig, ResidualModel& model) {
  MotionRange range = motion_range(model.rows());
  if (rig.kind != RigKind::vessel) return range;
  for (const ResidualCourse& course : model.courses({rig, {}}))
    if (!course.measured.empty()) range.first_Pa = std::max(range.first_Pa, course.measured.front());
  return range;
}

/// Machines as the answer has them, diagnosed by the owner's config; whatever becomes of that, the verdict stands.
void test_itself(const Rig& rig, const Rig& configured, const std::vector<RecordedMotion>& motions,
                 const DiagnoseOptions& options, Diagnosis& out) {
  DiagnoseOptions again = options;
  again.self_test = 0;
  again.with_curve = false;
  again.virtual_machine = {};
  again.progress = {};
  int done = 0;
  const auto play = [&](const Rig& machine, const RecordedMotion& motion) {
    look_for_stop(options.stop);
    std::optional<Recording> recording = options.following_machine(machine, motion);
    look_for_stop(options.stop);
    return recording;
  };
  const auto judge = [&](std::vector<Recording> played) {
    if (options.progress) options.progress(0.99, fmt::format("self-test {} of {}", ++done, options.self_test));
    return diagnose(configured, std::move(played), again);
  };
  try {
    add_self_test(rig, motions, options.self_test, play, judge, out);
  } catch (const DiagnosisStopped&) {
    out.warnings.emplace_back("stopped early: the verdict is complete, its self-test was not made");
  } catch (const std::exception& error) { out.warnings.push_back(fmt::format("no self-test: {}", error.what())); }
}

}  // namespace

std::unique_ptr<ResidualModel> make_residual_model(const Rig& rig, const std::vector<Recording>& recordings, int jobs,
                                                   const StopQuestion& stop) {
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
  settings.stop = stop;
  return std::make_unique<CylinderResiduals>(rig, recordings, settings);
}

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

Diagnosis diagnose(const Rig& rig, ResidualModel& model, const DiagnoseOptions& options) {
  const StopWhileAlive stoppable(model, options.stop);
  FittedRows rows(model, options.stop);
  require_comparison(rig, rows);
  std::vector<Candidate> candidates =
      shown_candidates(all_candidates(rig, model.channels(), range_of(rig, model)), model.rows());
  std::erase_if(candidates, [&](const Candidate& c) {
    return std::find(options.left_out.begin(), options.left_out.end(), c.name) != options.left_out.end();
  });
  SearchSettings settings;
  settings.left_out = options.left_out;
  Search search(rows, rig, candidates, settings, options.rules, options.progress);
  Diagnosis out = empty_diagnosis(rig);
  try {
    search.run();
    std::optional<Search> beside;
    Decision decision = decided_twice(rig, rows, search, options.rules, options.progress, beside, out.warnings);
    if (options.progress) options.progress(later_search.end, "verdict");
    const Search& used = beside ? *beside : search;
    std::vector<Screened> screening = screened_beside(rig, rows, used, decision, options.rules);
    const LatentJudgement judgement = judge_by_latents(rows, decision, used, options.rules);
    take_refuted_names(judgement, used, options.rules, decision);
    tell(rig, model, decision, judgement, used, screening, options, out);
  } catch (const DiagnosisStopped&) {
    if (search.owner().fit.z.size() == 0) throw;
    KnownRows known(model);
    out = empty_diagnosis(rig);
    out.stopped = true;
    out.warnings.emplace_back("stopped early: names not yet tried are missing, and no fit need be at its end");
    tell(rig, known, decided(rig, known, search, options.rules), {}, search, search.first_screening(), options, out);
  }
  out.hypotheses_tried = rows.hypotheses_tried();
  return out;
}

PreparedDiagnosis prepare_diagnosis(const Rig& configured, std::vector<Recording> recordings, std::string_view verb,
                                    const DiagnoseOptions& options) {
  if (recordings.empty()) throw InputError(fmt::format("{}: no recording, expected at least one", verb));
  if (configured.controls_pressure())
    throw InputError(fmt::format("{}: rig: found pressure, expected another kind: {} has no residuals of it",
                                 recordings.front().path, verb));
  PreparedDiagnosis out;
  out.rig = without_disturbances(configured, out.warnings);
  if (options.progress) options.progress(0.01, "recordings");
  const std::vector<std::string> told = told_of(out.rig, recordings);
  look_for_stop(options.stop);
  doubt_recordings(out.rig, recordings, out.warnings);
  look_for_stop(options.stop);
  TellingPieces pieces = telling_pieces(out.rig, compared_stretches(out.rig, std::move(recordings), out.warnings));
  if (options.progress) options.progress(0.02, "model of the recordings");
  out.model = make_residual_model(out.rig, pieces.recordings, options.jobs, options.stop);
  for (const Recording& piece : pieces.recordings) out.recordings.push_back(piece.path);
  out.coverage = std::move(pieces.coverage);
  out.warnings.insert(out.warnings.end(), told.begin(), told.end());
  return out;
}

Diagnosis diagnose(const Rig& configured, std::vector<Recording> recordings, const DiagnoseOptions& options) {
  const std::vector<RecordedMotion> motions =
      options.self_test > 0 ? motions_of(recordings) : std::vector<RecordedMotion>{};
  PreparedDiagnosis prepared = prepare_diagnosis(configured, std::move(recordings), "diagnose", options);
  DiagnoseOptions of_these = options;
  of_these.is_whole = prepared.coverage.choice.empty();
  Diagnosis out = diagnose(prepared.rig, *prepared.model, of_these);
  out.coverage = std::move(prepared.coverage);
  out.recordings = std::move(prepared.recordings);
  out.warnings.insert(out.warnings.end(), prepared.warnings.begin(), prepared.warnings.end());
  if (options.self_test > 0) test_itself(prepared.rig, configured, motions, of_these, out);
  return out;
}

}  // namespace pneuservo
