// Verb improve: from recordings of a machine to a config that controls it better.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "diagnosis/diagnose.hpp"
#include "loop/realtime_stop.hpp"
#include "program/long_work.hpp"
#include "program/loop_check.hpp"
#include "program/output_files.hpp"
#include "program/recording_choice.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "report/improvement.hpp"

namespace pneuservo {
namespace {

struct ImproveOptions {
  std::string config, improved, json, report;
  RecordingChoice recordings;
  std::vector<std::string> sets;
  int jobs = 0;
  bool force = false, quiet = false;
};

/// A call takes up to a minute and names one or two effects; machines with three are done after two.
constexpr std::size_t most_calls = 4;
constexpr const char* nothing_written = "pneuservo: stopped, nothing is written";

/// MINE.yaml becomes MINE-improved.yaml in the folder where one is.
std::string usual_name(const std::string& config) {
  return std::filesystem::path(config).stem().string() + "-improved.yaml";
}

/// Numbers of another machine are worse than none.
void require_own_recordings(const std::string& config, const Rig& rig, const std::vector<Recording>& recordings) {
  for (const Recording& recording : recordings)
    if (!recording.rig.empty() && recording.rig != rig.name)
      throw InputError(fmt::format("{}: found a recording of the rig '{}', expected one of '{}', the name in {}",
                                   recording.path, recording.rig, rig.name, config));
}

ImprovementCall call_of(const Diagnosis& diagnosis) {
  return {diagnosis.verdict, diagnosis.sentence, diagnosis.answers, diagnosis.unsaid, diagnosis.floors_left};
}

/// Keys in which a rig differs from the owner's.
std::set<std::string> changed_keys(const Rig& owner, const Rig& rig) {
  std::set<std::string> out;
  for (const ChangedNumber& change : changed_numbers(owner, rig)) out.insert(change.path);
  return out;
}

/// Diagnoses again from what was found, until nothing is missing, a call gains nothing, or none names anything new.
void diagnose_while_it_gains(const ImproveOptions& options, const std::vector<Recording>& recordings,
                             ProgressLine& progress, Improvement& out) {
  while (out.calls.size() < most_calls) {
    EarlyStop early_stop(nothing_written);
    DiagnoseOptions settings;
    settings.jobs = options.jobs;
    settings.stop = StopRequest::requested;
    settings.progress = [&](double share, const std::string& what) {
      if (share >= search_begins) early_stop.end();
      progress.tell(share, fmt::format("call {}: {}", out.calls.size() + 1, what));
    };
    const Diagnosis found = diagnose(out.improved, recordings, settings);
    if (found.stopped) throw DiagnosisStopped();
    const ImprovementCall call = call_of(found);
    const bool gains = out.calls.empty() || call.floors_left < out.calls.back().floors_left;
    const bool repeats = !out.calls.empty() && std::ranges::includes(changed_keys(out.configured, out.improved),
                                                                     changed_keys(out.configured, found.improved));
    out.calls.push_back(call);
    if (!gains) return;
    out.improved = found.improved;
    if (call.verdict == Verdict::consistent || repeats) return;
  }
}

/// A fit that ends at a bound says that something else is there.
std::string bound_words(const Improvement& improvement) {
  for (const ImprovementCall& call : improvement.calls)
    for (const auto* answers : {&call.answers, &call.unsaid})
      for (const DiagnosisAnswer& answer : *answers)
        for (const EstimatedParameter& parameter : answer.parameters)
          if (parameter.is_at_bound)
            return fmt::format(
                "{} of {} is at the bound of what is looked for ({:.4g}), so something else may be there",
                parameter.name, answer.effect, parameter.value);
  return "";
}

/// The run as it comes out on the improved model.
RunResult predicted(const Rig& law, const Rig& improved) {
  Rig machine = improved;
  machine.deviations.clear();
  machine.concealed.clear();
  return simulated_run(law, machine);
}

/// What the config does today, without its pass where it has none. It does not know the machine: its cross-checks
/// would end the motion.
RunResult predicted_before(const Improvement& improvement) {
  Rig law = improvement.configured;
  law.limits.flow_mismatch_share = law.limits.chamber_mismatch_Pa = 0.0;
  for (;;) try {
      return predicted(law, improvement.improved);
    } catch (const std::invalid_argument&) {
      if (!law.controller.wants_pass()) return {};
      law.controller.of<PdForce>().flow_feedforward = FeedforwardSource::formula;
    }
}

/// With the pass, or why there is none.
void predict_after(Improvement& out) {
  PdForceParameters& law = out.improved.controller.of<PdForce>();
  const FeedforwardSource configured = law.flow_feedforward;
  law.flow_feedforward = FeedforwardSource::pass;
  out.without_pass = bound_words(out);
  if (out.without_pass.empty()) try {
      out.after = predicted(out.improved, out.improved);
      const double ratio = out.error_ratio();
      if (!out.after.faults.empty())
        out.without_pass = "the simulated run with it ended by " + out.after.faults.front();
      else if (ratio > 1.0) out.without_pass = fmt::format("on the model it errs {:.3g} times as much", ratio);
    } catch (const std::invalid_argument& error) { out.without_pass = error.what(); }
  if (out.without_pass.empty()) return;
  const bool asks_for_pass = configured == FeedforwardSource::pass;
  law.flow_feedforward =
      asks_for_pass || law.without_pass == WithoutPass::formula ? FeedforwardSource::formula : configured;
  if (asks_for_pass)
    out.warnings.emplace_back("controller.flow_feedforward was pass and is formula now, for there is no pass");
  try {
    out.after = predicted(out.improved, out.improved);
  } catch (const std::invalid_argument&) { out.after = {}; }
}

void predict(Improvement& out) {
  if (out.configured.reference.kind == ReferenceKind::live) {
    out.without_pass = "reference.kind is live, and a pass needs a reference that is known beforehand";
    return;
  }
  if (out.calls.back().verdict == Verdict::unknown)
    out.warnings.emplace_back(
        "the last call leaves something that no name explains; the prediction knows nothing of it");
  out.before = predicted_before(out);
  predict_after(out);
  if (out.after.verdict.oscillates)
    out.warnings.push_back(fmt::format("the loop swings at {:.3g} Hz with what was found: lower "
                                       "controller.force_gain_V_per_N, or design the gains (pneuservo design)",
                                       out.after.verdict.oscillation_Hz));
}

/// What was found may be more than a limit of the config allows: then the config is refused where it is read.
void write_config(Improvement& improvement) {
  std::string text;
  for (const ImprovementCall& call : improvement.calls) text += "# " + call.sentence + "\n";
  text += dump_rig(improvement.improved);
  write_result(improvement.written, text);
  try {
    parse_rig(text, improvement.written);
  } catch (const InputError& error) {
    improvement.is_refused = true;
    improvement.warnings.emplace_back(error.what());
  }
}

void judge_outputs(const ImproveOptions& options, const Rig& rig) {
  const auto existing = options.force ? ExistingFile::replace : ExistingFile::refuse;
  OutputFiles()
      .reads("CONFIG", options.config)
      .reads_of(rig)
      .reads("RECORDING", options.recordings.recordings)
      .reads("--held-out", options.recordings.held_out)
      .writes("--improved", options.improved, ResultKind::config, existing)
      .writes("--json", options.json, ResultKind::json)
      .writes("--report", options.report, ResultKind::page);
}

int run_improve(ImproveOptions& options) {
  const Rig rig = read_rig(options.config, options.sets);
  require_valves("improve", options.config, rig, 1);
  if (!rig.controller.is<PdForce>())
    throw InputError(fmt::format("{}: controller.kind: found {}, expected {}, the law that follows a command pass",
                                 options.config, rig.controller.name(), PdForce::name));
  if (options.improved.empty()) options.improved = usual_name(options.config);
  if (options.improved == "-") throw InputError("--improved: found -, expected the name of a file");
  judge_outputs(options, rig);
  const StopRequest stop_request;
  ProgressLine progress(!options.quiet);
  Improvement improvement;
  improvement.configured = improvement.improved = rig;
  improvement.written = options.improved;
  try {
    std::vector<Recording> recordings;
    {
      EarlyStop early_stop(nothing_written);
      recordings = read_all(options.recordings, rig);
    }
    require_own_recordings(options.config, rig, recordings);
    diagnose_while_it_gains(options, recordings, progress, improvement);
  } catch (const DiagnosisStopped&) {
    progress.end();
    std::fprintf(stderr, "%s\n", nothing_written);
    return 128 + StopRequest::signal_number();
  }
  EarlyStop early_stop(nothing_written);
  progress.tell(1.0, "command pass and prediction");
  predict(improvement);
  improvement.changes = changed_numbers(rig, improvement.improved);
  early_stop.end();
  progress.end();
  write_config(improvement);
  if (options.json != "-") std::fputs(improvement_text(improvement).c_str(), stdout);
  write_json(options.json, improvement_json(improvement));
  if (!options.report.empty()) write_improvement_report(improvement, options.report);
  return improvement.without_pass.empty() && !improvement.is_refused ? 0 : 1;
}

}  // namespace

void add_improve(CommandLine& app, int& status) {
  auto options = std::make_shared<ImproveOptions>();
  Verb verb = app.add_verb("improve", "a config that controls the machine of these recordings better");
  verb.add_option("CONFIG", options->config, "rig as the owner believes it is, with tolerances").required();
  add_recording_options(verb, options->recordings);
  verb.add_option("--improved", options->improved, "the improved config; default: CONFIG's name with -improved, here");
  verb.add_flag("--force", options->force, "--improved may replace a config that this program wrote");
  verb.add_option("--json", options->json, "result as JSON; - for standard output");
  verb.add_option("--report", options->report, "self-contained HTML page with before and after");
  verb.add_option("--jobs", options->jobs, "threads; 0: all of the machine").within(0, 1024);
  add_set_option(verb, options->sets);
  verb.add_flag("--quiet", options->quiet, "no progress");
  verb.footer(
      "Diagnoses the recordings, again from what was found while that gains, writes the improved config, makes\n"
      "its command pass and predicts the error that remains.\n"
      "Exit status: 0 with a command pass; 1 without one, or where the improved config is refused: a sentence says "
      "why.");
  verb.callback([options, &status] { status = run_improve(*options); });
}

}  // namespace pneuservo
