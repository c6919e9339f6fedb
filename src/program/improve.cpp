// Verb improve: from recordings of a machine to a config that controls it better.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "diagnosis/search/search.hpp"
#include "improve/improve.hpp"
#include "loop/realtime_stop.hpp"
#include "program/long_work.hpp"
#include "program/output_files.hpp"
#include "program/recording_choice.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/result_file.hpp"

namespace pneuservo {
namespace {

struct ImproveVerb {
  std::string config, improved, json, report;
  RecordingChoice recordings;
  std::vector<std::string> sets;
  int jobs = 0;
  bool force = false, quiet = false;
};

constexpr const char* nothing_written = "pneuservo: stopped, nothing is written";

/// MINE.yaml becomes MINE-improved.yaml in the folder where one is.
std::string usual_name(const std::string& config) {
  return std::filesystem::path(config).stem().string() + "-improved.yaml";
}

void judge_outputs(const ImproveVerb& options, const Rig& rig) {
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

/// Before the search and in the prediction. Looks for a stop are far apart there: it ends the program at once.
bool ends_at_once(double share) { return share < first_search.begin || share >= 1.0; }

Improvement improve_watched(const ImproveVerb& verb, const Rig& rig) {
  ProgressLine progress(!verb.quiet);
  std::optional<EarlyStop> early_stop(nothing_written);
  const std::vector<Recording> recordings = read_all(verb.recordings, rig);
  ImproveOptions options;
  options.jobs = verb.jobs;
  options.stop = StopRequest::requested;
  options.progress = [&](double share, const std::string& what) {
    if (!ends_at_once(share)) early_stop.reset();
    else if (!early_stop) early_stop.emplace(nothing_written);
    progress.tell(share, what);
  };
  return improve(verb.config, rig, recordings, options);
}

int run_improve(ImproveVerb& options) {
  const Rig rig = read_rig(options.config, options.sets);
  require_improvable(options.config, rig);
  if (options.improved.empty()) options.improved = usual_name(options.config);
  if (options.improved == "-") throw InputError("--improved: found -, expected the name of a file");
  judge_outputs(options, rig);
  const StopRequest stop_request;
  Improvement improvement;
  try {
    improvement = improve_watched(options, rig);
    look_for_stop([&] { return improvement.stopped; });
  } catch (const DiagnosisStopped&) {
    std::fprintf(stderr, "%s\n", nothing_written);
    return 128 + StopRequest::signal_number();
  }
  improvement.written = options.improved;
  const std::string text = improved_config_text(improvement);
  write_result(improvement.written, text);
  judge_improved_config(improvement, text, improvement.written);
  if (options.json != "-") std::fputs(improvement_text(improvement).c_str(), stdout);
  write_json(options.json, improvement_json(improvement));
  if (!options.report.empty()) write_improvement_report(improvement, options.report);
  return improvement.without_pass.empty() && !improvement.is_refused ? 0 : 1;
}

}  // namespace

void add_improve(CommandLine& app, int& status) {
  auto options = std::make_shared<ImproveVerb>();
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
