// Verb diagnose: where and why recordings of the real machine differ from its config.
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/result_json.hpp"
#include "diagnosis/result_text.hpp"
#include "loop/realtime_stop.hpp"
#include "program/long_work.hpp"
#include "program/output_files.hpp"
#include "program/recording_choice.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "program/virtual_machine.hpp"
#include "record/result_file.hpp"
#include "report/diagnosis_report.hpp"

namespace pneuservo {
namespace {

struct DiagnoseVerbOptions {
  std::string config, json, report, improved, next_experiment, picture;
  RecordingChoice recordings;
  std::vector<std::string> sets, left_out;
  int jobs = 0, self_test = 0;
  bool as_curve = false, quiet = false;
};

constexpr const char* nothing_known = "pneuservo: stopped before anything was known";

void write_improved(const DiagnoseVerbOptions& options, const Diagnosis& diagnosis) {
  if (options.improved.empty()) return;
  const std::string stopped =
      diagnosis.stopped ? "# Stopped early: not the result of a finished diagnosis, and not to be run with.\n" : "";
  write_result(options.improved, stopped + "# " + diagnosis.sentence + "\n" + dump_rig(diagnosis.improved));
}

/// The config of the proposed recording; where there is none, nothing is written and that is said.
void write_next_experiment(const DiagnoseVerbOptions& options, const Diagnosis& diagnosis) {
  if (options.next_experiment.empty()) return;
  if (!diagnosis.next_experiment) {
    std::fprintf(stderr, "pneuservo: no next experiment: there are no rivals that a safe recording tells apart\n");
    return;
  }
  const ProposedExperiment& next = *diagnosis.next_experiment;
  std::string text = fmt::format("# Recording that tells {} apart.\n", fmt::join(next.between, " and "));
  if (!next.setup.empty()) text += fmt::format("# Before it: {}.\n", next.setup);
  text += fmt::format("# Then diagnose it {}.\n", next.use());
  write_result(options.next_experiment, text + dump_rig(experiment_rig(diagnosis.configured, next)));
}

void judge_outputs(const DiagnoseVerbOptions& options, const Rig& rig) {
  OutputFiles()
      .reads("CONFIG", options.config)
      .reads_of(rig)
      .reads("RECORDING", options.recordings.recordings)
      .reads("--held-out", options.recordings.held_out)
      .writes("--json", options.json, ResultKind::json)
      .writes("--report", options.report, ResultKind::page)
      .writes("--improved", options.improved, ResultKind::config)
      .writes("--next-experiment", options.next_experiment, ResultKind::config)
      .writes("--picture", options.picture, ResultKind::picture);
}

/// One row a point: when, what the machine did, what is missing with its standard deviation.
void write_picture(const UnknownPicture& picture, const std::string& path) {
  std::string text =
      fmt::format("# Missing: {} at {} [{}]; {}\nrecording,t_s,x_m,v_mps,u_V,p1_Pa,p2_Pa,missing,deviation\n",
                  picture.what, picture.element, picture.unit, picture.words);
  for (const PicturePoint& p : picture.points)
    text += fmt::format("{},{:.4f},{:.6f},{:.5f},{:.5f},{:.1f},{:.1f},{:.6g},{:.6g}\n", p.recording + 1, p.time_s,
                        p.position_m, p.velocity_mps, p.command_V, p.p1_Pa, p.p2_Pa, p.mean, p.deviation);
  write_result(path, text);
}

void write_results(const DiagnoseVerbOptions& options, const Diagnosis& diagnosis) {
  if (options.json != "-") std::fputs(diagnosis_text(diagnosis).c_str(), stdout);
  write_json(options.json, diagnosis_json(diagnosis));
  if (!options.report.empty()) write_diagnosis_report(diagnosis, options.report);
  write_improved(options, diagnosis);
  write_next_experiment(options, diagnosis);
  if (options.picture.empty()) return;
  if (diagnosis.picture) write_picture(*diagnosis.picture, options.picture);
  else
    std::fputs(
        fmt::format(
            "pneuservo: {} is not written: found the verdict {}, expected unknown at an element with a free function\n",
            options.picture, verdict_names[static_cast<std::size_t>(diagnosis.verdict)])
            .c_str(),
        stderr);
}

int run_diagnose(const DiagnoseVerbOptions& options) {
  const Rig rig = read_rig(options.config, options.sets);
  judge_outputs(options, rig);
  const StopRequest stop_request;
  EarlyStop early_stop(nothing_known);
  ProgressLine progress(!options.quiet);
  DiagnoseOptions settings;
  settings.jobs = options.jobs;
  settings.left_out = options.left_out;
  settings.with_curve = options.as_curve;
  settings.self_test = options.self_test;
  settings.following_machine = follow_virtually;
  // It takes longer than the diagnosis itself: only for those who look at it.
  if (!options.next_experiment.empty() || !options.report.empty()) settings.virtual_machine = record_virtual_run;
  settings.stop = StopRequest::requested;
  settings.progress = [&](double share, const std::string& what) {
    if (share >= first_search.begin) early_stop.end();
    progress.tell(share, what);
  };
  Diagnosis diagnosis;
  try {
    diagnosis = diagnose(rig, read_all(options.recordings, rig), settings);
  } catch (const DiagnosisStopped&) {
    progress.end();
    std::fprintf(stderr, "%s\n", nothing_known);
    return 128 + StopRequest::signal_number();
  }
  progress.end();
  const bool was_stopped = StopRequest::requested();
  write_results(options, diagnosis);
  return was_stopped ? 128 + StopRequest::signal_number() : 0;
}

}  // namespace

void add_diagnose(CommandLine& app, int& status) {
  auto options = std::make_shared<DiagnoseVerbOptions>();
  Verb verb = app.add_verb("diagnose", "where and why recordings of the machine differ from its config");
  verb.add_option("CONFIG", options->config, "rig as the owner believes it is, with tolerances").required();
  add_recording_options(verb, options->recordings);
  verb.add_option("--json", options->json, "result as JSON; - for standard output");
  verb.add_option("--report", options->report, "self-contained HTML page with pictures");
  verb.add_option("--improved", options->improved, "config with what was found, for run and simulate");
  verb.add_option("--next-experiment", options->next_experiment,
                  "config of the recording that tells rivals apart, for run; it is also sought for --report");
  verb.add_option("--picture", options->picture, "course of an unknown as CSV");
  verb.add_flag("--as-curve", options->as_curve,
                "of an unknown: a table in its place (force over position, speed or time; leak over pressure; valve's "
                "area over command), in --improved, too");
  verb.add_option(
          "--self-test", options->self_test,
          "so many machines as the answer has them are simulated and diagnosed as well, each in the time of this "
          "one; no probability is told above the share that got the name")
      .within(0, 1000);
  verb.add_option("--leave-out", options->left_out, "name that is not tried, for tools/ablation-trial").hidden();
  verb.add_option("--jobs", options->jobs, "threads; 0: all of the machine").within(0, 1024);
  add_set_option(verb, options->sets);
  verb.add_flag("--quiet", options->quiet, "no progress");
  verb.callback([options, &status] { status = run_diagnose(*options); });
}

}  // namespace pneuservo
