// Verb diagnose: where and why recordings of the real machine differ from its config.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/number_text.hpp"
#include "config/read_rig.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/result_json.hpp"
#include "diagnosis/result_text.hpp"
#include "loop/realtime_stop.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "program/virtual_machine.hpp"
#include "record/import.hpp"
#include "report/diagnosis_report.hpp"

namespace pneuservo {
namespace {

struct DiagnoseVerbOptions {
  std::string config, json, report, improved, next_experiment, picture;
  std::vector<std::string> recordings, held_out, changed, sets, left_out;
  int jobs = 0;
  bool latent = false, quiet = false;
};

constexpr const char* nothing_known = "pneuservo: stopped before anything was known";

/// What goes on: one line that is overwritten on a terminal, a line every few seconds elsewhere. A thread of its own
/// shows it, so that long steps have their seconds told too.
class ProgressLine {
 public:
  explicit ProgressLine(bool is_shown) {
    if (is_shown) thread_ = std::jthread([this](const std::stop_token& stop) { show(stop); });
  }
  ~ProgressLine() { end(); }
  void tell(double share, const std::string& what) {
    const std::lock_guard lock(mutex_);
    share_ = share;
    what_ = what;
  }
  void end() {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    thread_.join();
    if (is_terminal_) std::fprintf(stderr, "\r\033[K");
  }

 private:
  void show(const std::stop_token& stop) {
    const auto start = std::chrono::steady_clock::now();
    std::unique_lock lock(mutex_);
    auto wait = first_;
    while (!wake_.wait_for(lock, stop, wait, [] { return false; }) && !stop.stop_requested()) {
      const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      const std::string text = fmt::format("{:.0f} %, {:.0f} s: {}", 100 * share_, elapsed_s, what_);
      if (is_terminal_) std::fprintf(stderr, "\r\033[K%s", text.c_str());
      else std::fprintf(stderr, "pneuservo: %s\n", text.c_str());
      wait = is_terminal_ ? std::chrono::milliseconds(500) : std::chrono::milliseconds(5000);
    }
  }
  /// What is refused at once is refused in one line.
  static constexpr std::chrono::milliseconds first_{1500};

  const bool is_terminal_ = isatty(fileno(stderr)) != 0;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  double share_ = 0;
  std::string what_ = "reading";
  std::jthread thread_;
};

/// Until the search begins there is nothing to keep: a stop ends the program at once, whatever it is at.
class EarlyStop {
 public:
  EarlyStop() : thread_([this](const std::stop_token& end) { watch(end); }) {}
  /// From here on the diagnosis itself answers a stop.
  void end() {
    const std::lock_guard lock(mutex_);
    thread_.request_stop();
  }

 private:
  void watch(const std::stop_token& end) {
    std::unique_lock lock(mutex_);
    while (!end.stop_requested()) {
      if (StopRequest::requested()) {
        std::fprintf(stderr, "%s%s\n", isatty(fileno(stderr)) != 0 ? "\r\033[K" : "", nothing_known);
        _exit(128 + StopRequest::signal_number());
      }
      wake_.wait_for(lock, end, std::chrono::milliseconds(50), [] { return false; });
    }
  }
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

/// Columns that a diagnosis uses; the others need no memory.
const std::set<std::string>& used_columns() {
  static const std::set<std::string> used = [] {
    std::set<std::string> columns{"t_s", "x_ref_m", "u_V", "u1_V", "u2_V"};
    for (const SignalInfo& signal : signal_table) columns.emplace(signal.column);
    return columns;
  }();
  return used;
}

void keep_used_columns(Recording& recording) {
  recording.keep_columns([](const std::string& name) { return used_columns().contains(name); });
}

/// A recording that names another rig is told, not refused: configs are copied and renamed.
void compare_names(const Rig& rig, Recording& recording) {
  if (!recording.rig.empty() && recording.rig != rig.name)
    recording.report(0, ProblemKind::header,
                     fmt::format("was made with rig '{}', the config is '{}'", recording.rig, rig.name));
}

/// What --changed says of a recording.
struct StatedChange {
  std::set<std::string> paths;  ///< of the recordings meant
  std::string key;
  double value = 0;
};

/// RECORDING:PATH=VALUE; the recording by its path, or by its file's name where no other has the same.
StatedChange stated_change(const std::string& stated, const std::vector<Recording>& recordings) {
  StatedChange out;
  std::set<std::string> known;
  const auto name_of = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
  const auto take = [&](const std::string& path, const std::string& name) {
    if (!stated.starts_with(name + ":")) return;
    out.paths.insert(path);
    out.key = stated.substr(name.size() + 1);
  };
  for (const Recording& recording : recordings) known.insert(recording.path);
  for (const std::string& path : known) take(path, path);
  if (out.paths.empty())
    for (const std::string& path : known) take(path, name_of(path));
  const std::size_t equals = out.key.rfind('=');
  if (out.paths.size() != 1 || equals == std::string::npos)
    throw InputError(fmt::format("--changed {}: found {}, expected RECORDING:PATH=VALUE with one of {}", stated,
                                 out.paths.empty()       ? "no recording of that name"
                                 : out.paths.size() != 1 ? "several recordings of that name"
                                                         : "no value",
                                 fmt::join(known, ", ")));
  const std::string text = out.key.substr(equals + 1);
  const std::optional<double> value = number_from_text(text);
  if (!value || !std::isfinite(*value))
    throw InputError(fmt::format("--changed {}: found '{}', expected a number in the unit of its key", stated, text));
  out.value = *value;
  out.key.resize(equals);
  return out;
}

void apply_changes(const std::vector<std::string>& changes, std::vector<Recording>& recordings) {
  for (const std::string& stated : changes) {
    const StatedChange change = stated_change(stated, recordings);
    for (Recording& recording : recordings)
      if (change.paths.contains(recording.path)) recording.changed.emplace_back(change.key, change.value);
  }
}

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
      .reads("RECORDING", options.recordings)
      .reads("--held-out", options.held_out)
      .writes("--json", options.json, ResultKind::json)
      .writes("--report", options.report, ResultKind::page)
      .writes("--improved", options.improved, ResultKind::config)
      .writes("--next-experiment", options.next_experiment, ResultKind::config)
      .writes("--picture", options.picture, ResultKind::picture);
}

/// All recordings with the columns that are used and what is stated of them.
std::vector<Recording> read_all(const DiagnoseVerbOptions& options, const Rig& rig) {
  std::vector<Recording> recordings;
  std::set<std::string> wanted = used_columns();
  wanted.insert("flags");  // they tell which rows the recorder dropped
  const auto add = [&](const std::string& path, bool is_held_out) {
    for (Recording& run : read_recordings(path, rig.imported, rig.period_s, wanted)) {
      compare_names(rig, run);
      run.is_held_out = is_held_out;
      keep_used_columns(run);
      recordings.push_back(std::move(run));
    }
  };
  std::set<std::filesystem::path> seen;
  for (const auto* paths : {&options.recordings, &options.held_out})
    for (const std::string& path : *paths)
      if (!seen.insert(std::filesystem::weakly_canonical(path)).second)
        throw InputError(path +
                         ": found twice, expected each recording once; held-out ones are those that no fit sees");
  for (const std::string& path : options.recordings) add(path, false);
  for (const std::string& path : options.held_out) add(path, true);
  apply_changes(options.changed, recordings);
  return recordings;
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
  if (!options.picture.empty() && diagnosis.picture) write_picture(*diagnosis.picture, options.picture);
}

int run_diagnose(const DiagnoseVerbOptions& options) {
  const Rig rig = read_rig(options.config, options.sets);
  judge_outputs(options, rig);
  const StopRequest stop_request;
  EarlyStop early_stop;
  ProgressLine progress(!options.quiet);
  DiagnoseOptions settings;
  settings.jobs = options.jobs;
  settings.left_out = options.left_out;
  settings.with_free_functions = options.latent || !options.picture.empty();
  // It takes longer than the diagnosis itself: only for those who look at it.
  if (!options.next_experiment.empty() || !options.report.empty()) settings.virtual_machine = record_virtual_run;
  settings.stop = StopRequest::requested;
  settings.progress = [&](double share, const std::string& what) {
    if (share >= search_begins) early_stop.end();
    progress.tell(share, what);
  };
  Diagnosis diagnosis;
  try {
    diagnosis = diagnose(rig, read_all(options, rig), settings);
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
  verb.add_option("RECORDING", options->recordings, "recordings of the machine (.csv.gz)").required();
  verb.add_option("--held-out", options->held_out,
                  "recordings kept from every fit, for the proof; the others are then fitted whole");
  verb.add_option("--changed", options->changed,
                  "RECORDING:PATH=VALUE: what the machine had otherwise while this recording was made, e.g. "
                  "slow.csv.gz:supply.pressure_Pa=525e3");
  verb.add_option("--json", options->json, "result as JSON; - for standard output");
  verb.add_option("--report", options->report, "self-contained HTML page with pictures");
  verb.add_option("--improved", options->improved, "config with what was found, for run and simulate");
  verb.add_option("--next-experiment", options->next_experiment,
                  "config of the recording that tells rivals apart, for run; it is also sought for --report");
  verb.add_flag(
      "--latent", options->latent,
      "a free function of time at each element: where an unknown sits, how it looks, how large it could hide");
  verb.add_option("--picture", options->picture, "course of an unknown as CSV; with --latent");
  verb.add_option("--leave-out", options->left_out, "name that is not tried, for tools/ablation-trial").hidden();
  verb.add_option("--jobs", options->jobs, "threads; 0: all of the machine").within(0, 1024);
  add_set_option(verb, options->sets);
  verb.add_flag("--quiet", options->quiet, "no progress");
  verb.callback([options, &status] { status = run_diagnose(*options); });
}

}  // namespace pneuservo
