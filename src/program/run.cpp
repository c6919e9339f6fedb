// Verb run: the controller on a backend, in simulated or real time, with figures, recording and report.
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>

#include <unistd.h>

#include <fmt/format.h>

#include <pneuservo/loop/axis_loop.hpp>

#include "backends.hpp"
#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "loop/device_grade.hpp"
#include "loop/fault_watch.hpp"
#include "loop/realtime_stop.hpp"
#include "loop/runner.hpp"
#include "loop/safe_output_text.hpp"
#include "pass/learned_move.hpp"
#include "program/axis_options.hpp"
#include "program/gain_file.hpp"
#include "program/injection.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/run_variants.hpp"
#include "program/verbs.hpp"
#include "record/import.hpp"
#include "record/result_file.hpp"
#include "record/writer.hpp"
#include "report/evaluation.hpp"
#include "report/motion_verdict.hpp"
#include "report/run_json.hpp"
#include "report/run_report.hpp"
#include "report/run_summary.hpp"

namespace fs = std::filesystem;

namespace pneuservo {
namespace {

struct RunOptions : AxisOptions {
  RunOptions() { time = "simulated"; }
  std::string pressure_source, flow_feedforward, record, report, json, gains, live, learned;
  double duration_s = 0.0;
  double early_wake_us = -1.0;
  int moves = 1;
  bool dump_config = false, force = false;
  ExistingFile existing() const { return force ? ExistingFile::replace : ExistingFile::refuse; }
};

Rig read_with_options(const RunOptions& options) {
  std::vector<std::string> sets;
  if (options.duration_s > 0.0) sets.push_back(fmt::format("duration_s={}", options.duration_s));
  const auto choose = [&](const char* key, const std::string& word) {
    if (!word.empty() && word != every_variant) sets.push_back(fmt::format("controller.{}={}", key, word));
  };
  choose("pressure_source", options.pressure_source);
  choose("flow_feedforward", options.flow_feedforward);
  Rig rig = read_axis("run", options, sets);
  if (!rig.controller.closes_force_loop() && !options.pressure_source.empty())
    throw InputError(fmt::format("--pressure-source: found {}, but {} of {} takes no pressure into its loop",
                                 options.pressure_source, rig.controller.name(), options.config));
  if (!rig.controller.is<PdForce>() && !options.flow_feedforward.empty())
    throw InputError(fmt::format("--flow-feedforward: found {}, but {} of {} has none; expected {}",
                                 options.flow_feedforward, rig.controller.name(), options.config, PdForce::name));
  return rig;
}

bool learns_moves(const Rig& rig) { return rig.controller.is<PdForce>() && rig.controller.of<PdForce>().learns(); }

/// What the law takes pressures from.
std::string pressure_word(const ControllerParameters& controller) {
  const std::optional<PressureSource> source = controller.pressures();
  return source ? std::string(pressure_source_names[static_cast<std::size_t>(*source)]) : "none";
}

/// FILE.csv.gz, or FILE-valve.csv.gz and so on where several variants are run.
std::string record_path(const RunOptions& options, const RunVariant& variant) {
  constexpr std::string_view ending = ".csv.gz";
  if (options.record.empty() || variant.name.empty() || !options.record.ends_with(ending)) return options.record;
  return options.record.substr(0, options.record.size() - ending.size()) + "-" + variant.name + std::string(ending);
}

void show_progress(double fraction, std::string_view variant) {
  std::fprintf(stderr, "\r%-17.*s %3.0f %%", static_cast<int>(variant.size()), variant.data(),
               100.0 * std::min(fraction, 1.0));
}

/// Time of the axis that was run, and what it took.
struct Effort {
  double axis_s = 0.0, wall_s = 0.0;
};

/// What a law cannot follow becomes a sentence about the config.
RunOutcome run_or_refuse(const std::string& config, const Rig& rig, Backend& backend, const RunSettings& settings) {
  try {
    return run_loop(rig, backend, settings);
  } catch (const std::invalid_argument& error) { throw InputError(config + ": " + error.what()); }
}

/// Told while the loop still runs, and whatever the recording's disk does.
void tell_fault(std::uint64_t first_faults) {
  std::string text;
  for (const std::string& fault : fault_words(first_faults, first_faults)) text += "fault: " + fault + "\n";
  std::cerr << text;
}

/// The recording of a run; none without --record.
std::unique_ptr<RecordingWriter> open_recording(const RunOptions& options, const Rig& rig, const Backend& backend,
                                                const Facts& machine, const std::string& path) {
  if (path.empty()) return nullptr;
  const bool real_time = options.time == "real";
  const auto columns = recorded_columns(rig, backend, {.real_time = real_time});
  const auto terms = law_columns(rig.controller.kind);
  RecordingOptions recording{.existing = options.existing(), .terms = terms};
  if (!options.live.empty()) recording.live = std::make_shared<LiveValues>(options.live, columns, terms);
  if (real_time) recording.ring = std::make_shared<RecordingRing>();
  return std::make_unique<RecordingWriter>(path, run_header(rig, backend, machine, options.moves), columns,
                                           std::move(recording));
}

/// Ends the recording; true: every row is in it. A stop signal that comes while its disk hangs is obeyed.
bool close_recording(RecordingWriter* writer) {
  if (writer == nullptr) return true;
  const auto begin = std::chrono::steady_clock::now();
  const int signals = StopRequest::signals();
  const RecordingSummary summary = writer->close([&] {
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - begin;
    return waited.count() > StopRequest::patience_s && StopRequest::signals() > signals;
  });
  if (summary.dropped > 0)
    std::cerr << fmt::format("{}: {} rows were dropped, the writer came too late\n", writer->path(), summary.dropped);
  if (!summary.error.empty()) std::cerr << summary.error << "\n";
  return summary.whole();
}

/// What is to be said beside the results; the first fault was told when it came.
void tell_end(const RunOptions& options, const Rig& rig, const Backend& backend, const RunOutcome& outcome,
              bool whole) {
  for (const std::string& note : backend.notes()) std::cerr << note << "\n";
  if (outcome.moves_not_learned > 0)
    std::cerr << fmt::format(
        "{} of {} moves taught nothing: more than 1 % of their ticks were skipped because the loop "
        "was late; `pneuservo check` names what to mend on this machine\n",
        outcome.moves_not_learned, outcome.moves_begun);
  if (outcome.repeated_move) std::cerr << learning_words(outcome.repeated_move->progress());
  const std::string safe = safe_output_text(backend.safe_output(), rig);
  if (outcome.stopped_by_signal) {
    const std::string name = StopRequest::signal_name();
    std::cerr << fmt::format("stopped by {}: {}{}results so far follow\n", name.empty() ? "the program" : name,
                             outcome.faults.empty() ? safe + "; " : "",
                             options.record.empty() ? ""
                             : whole                ? "the recording is closed, "
                                                    : "the recording is not whole, ");
  }
  for (std::size_t i = outcome.first_faults; i < outcome.faults.size(); ++i)
    std::cerr << "after it: " << outcome.faults[i] << "\n";
  if (!outcome.faults.empty())
    std::cerr << safe << "\n"
              << "when the cause is mended, run the same command again"
              << (options.record.empty() ? "\n" : " with another name after --record\n");
}

/// A move for the report. Of a long run only the last rows are kept: its window begins where they do.
RunResult result_of(const Rig& rig, const RunOutcome& outcome, const MoveSpan& span) {
  RunResult run;
  run.pressure_source = pressure_word(rig.controller);
  run.feedforward = rig.controller.feedforward_name();
  run.move = span.number;
  run.start_s = span.start_s;
  run.rows.assign(outcome.rows.begin() + static_cast<std::ptrdiff_t>(span.begin),
                  outcome.rows.begin() + static_cast<std::ptrdiff_t>(span.end));
  if (std::isfinite(outcome.motion_limits.deviation_m)) run.deviation_limit_m = outcome.motion_limits.deviation_m;
  if (&span == &outcome.moves.back() && !outcome.faults.empty()) {
    run.faults = outcome.faults;
    run.fault_s = outcome.fault_s;
  }
  run.ticks = static_cast<std::int64_t>(run.rows.size() + span.rows_lost);
  run.overruns = span.overruns;
  if (outcome.timing) run.timing = *outcome.timing;
  if (rig.controls_pressure()) {
    run.pressure = evaluate_pressure(rig, run.rows, run.start_s);
    return run;
  }
  run.metrics = evaluate(rig, run.rows, run.start_s);
  if (span.rows_lost > 0) run.metrics.from_s = std::max(run.metrics.from_s, run.rows.front().t_s - run.start_s);
  run.verdict = judge_motion(rig, run);
  return run;
}

/// Of a long run: time of the first row that figures and page show.
void note_what_is_shown(const RunOutcome& outcome, RunReport& report) {
  if (outcome.moves.empty()) return;
  const MoveSpan& first = outcome.moves.front();
  if (first.number > 1 || first.rows_lost > 0) report.shown_from_s = outcome.rows[first.begin].t_s;
}

/// All moves with the longest approach before each.
double longest_run_s(const Rig& rig, int moves) { return moves * (rig.duration_s + longest_start_s(rig)); }

/// Where what a run began with stays.
std::string before_learned(const std::string& path) { return path + ".before"; }

/// Writes what was learned; what the run began with stays as FILE.before, which a replay needs.
void keep_learned(const std::string& path, const Rig& rig, const RepeatedMove& move) {
  if (fs::exists(path)) fs::rename(path, before_learned(path));
  write_result(path, learned_move_text(rig.name, move));
}

/// One run from start to safe end; its moves are added to the report. True: no fault, recording whole.
bool run_variant(const RunOptions& options, const RunVariant& variant, RunReport& report, Effort& effort) {
  const Rig& rig = variant.rig;
  const bool real_time = options.time == "real", shows_progress = !real_time && isatty(STDERR_FILENO) != 0;
  const std::unique_ptr<RealTimeSession> session = realtime_session(options);
  if (session && report.runs.empty()) std::cerr << refusal_message(session->findings());
  const std::vector<InjectedFault> faults = injected_faults(options.scenarios, options.faults, rig);
  auto backend = make_faulty_backend(backend_of(options, rig), rig, faults);
  if (report.runs.empty() && backend->name() == "configured") std::cerr << device_warning(rig);
  backend->configure();
  report.machine = machine_facts(session ? &session->state() : nullptr);
  report.channel_origins = channel_facts(*backend);

  const std::string path = record_path(options, variant);
  const auto writer = open_recording(options, rig, *backend, report.machine, path);
  auto watch = std::make_unique<FaultWatch>([](auto first, double) { tell_fault(first); });
  RunSettings settings{.real_time = real_time,
                       .early_wake_s = options.early_wake_us * 1e-6,
                       .moves = options.moves,
                       .load = load_reference_positions,
                       .ring = writer ? writer->ring() : nullptr,
                       .writer = real_time ? nullptr : writer.get(),
                       .fault_watch = watch.get(),
                       .recording = path,
                       .late = late_ticks(faults, rig.period_s, longest_run_s(rig, options.moves)),
                       .suspends = suspends(faults, rig.period_s)};
  if (!options.learned.empty() && fs::exists(options.learned))
    settings.learned = [&](const RepeatedMove& move) { return read_learned_move(options.learned, move); };
  if (shows_progress) settings.progress = [&](double fraction) { show_progress(fraction, variant.name); };
  GainMailbox mailbox;
  std::unique_ptr<GainFileWatcher> watcher;
  if (!options.gains.empty()) {
    settings.gains = &mailbox;
    watcher = std::make_unique<GainFileWatcher>(options.gains, options.config, options.sets, mailbox);
  }
  RunOutcome outcome = run_or_refuse(options.config, rig, *backend, settings);
  effort.wall_s += outcome.wall_s;
  effort.axis_s += static_cast<double>(outcome.ticks + outcome.overruns) * rig.period_s;
  if (shows_progress) std::fputs("\r                       \r", stderr);
  const bool whole = close_recording(writer.get());
  watcher.reset();
  watch.reset();
  tell_end(options, rig, *backend, outcome, whole);
  if (!options.learned.empty() && outcome.repeated_move) keep_learned(options.learned, rig, *outcome.repeated_move);
  note_what_is_shown(outcome, report);
  for (const MoveSpan& span : outcome.moves) report.runs.push_back(result_of(rig, outcome, span));
  return outcome.faults.empty() && whole;
}

/// What would only show after the run: no such backend, no such folder, a file that must stay.
void check_outputs(const RunOptions& options, const Rig& rig, const std::vector<RunVariant>& variants) {
  make_faulty_backend(backend_of(options, rig), rig, injected_faults(options.scenarios, options.faults, rig));
  if (!options.record.empty() && !options.record.ends_with(".csv.gz"))
    throw InputError("--record: found " + options.record + ", expected a name that ends in .csv.gz");
  if (!options.live.empty() && options.record.empty())
    throw InputError("--live: found without --record, whose thread sends the values");
  OutputFiles files;
  files.reads("CONFIG", options.config)
      .reads_of(rig)
      .reads("--zeros", options.zeros)
      .reads("--scenario", options.scenarios)
      .reads("--gains", options.gains);
  for (const RunVariant& variant : variants)
    files.records("--record", record_path(options, variant), options.existing());
  files.writes("--learned", options.learned, ResultKind::learned_move);
  if (!options.learned.empty()) files.writes("--learned", before_learned(options.learned), ResultKind::learned_move);
  files.writes("--report", options.report, ResultKind::page).writes("--json", options.json, ResultKind::json);
}

int run(const RunOptions& options) {
  if (options.moves < 1) throw InputError(fmt::format("--moves: found {}, expected 1 or more", options.moves));
  Rig rig = read_with_options(options);
  if (!options.gains.empty() && !rig.controller.is<Ppd2>())
    throw InputError(
        fmt::format("--gains: found with controller.kind {}, expected {}", rig.controller.name(), Ppd2::name));
  if (options.dump_config) {
    std::cout << dump_rig(rig);
    return 0;
  }
  auto variants = run_variants(rig, options.pressure_source, options.flow_feedforward);
  if (!options.learned.empty() && (!learns_moves(variants.front().rig) || variants.size() > 1))
    throw InputError(
        "--learned: found without controller.learning: command and flow_feedforward: pass, or with more than "
        "one run; expected a law that learns a move");
  check_outputs(options, rig, variants);
  heed_axis(options, rig);
  heed_passes(options.config, variants);  // before a device is touched or a recording begun
  StopRequest stop;
  RunReport report;
  const Rig& shown = variants.size() == 1 ? variants.front().rig : rig;
  report.config = rig.name;
  report.time = options.time;
  report.duration_s = rig.duration_s;
  report.period_s = rig.period_s;
  report.config_yaml = dump_rig(shown);
  bool good = true;
  Effort effort;
  for (const RunVariant& variant : variants) {
    good = run_variant(options, variant, report, effort) && good;
    if (StopRequest::requested()) break;
  }
  StopRequest::let_go(StopRequest::patience_s);
  if (effort.wall_s > 0.0) report.realtime_factor = effort.axis_s / effort.wall_s;
  if (options.json != "-") std::cout << run_text(report);
  write_json(options.json, run_json(report));
  if (!options.report.empty()) write_run_report(report, shown, options.report);
  return good ? 0 : 1;
}

}  // namespace

void add_run(CommandLine& app, int& status) {
  auto o = std::make_shared<RunOptions>();
  Verb verb = app.add_verb("run", "run the controller on the configured backend");
  add_axis_options(verb, *o, "rig to run, e.g. config/cylinder-10m-7.65mm.yaml");
  verb.add_option("--pressure-source", o->pressure_source,
                  "pressures that close the force loop; all: valve, chamber and estimated, compared")
      .among({"valve", "chamber", "estimated", "differential", "all"});
  verb.add_option("--flow-feedforward", o->flow_feedforward,
                  "where a pd_force law's feedforward comes from; all: off, formula and pass, compared")
      .among({"off", "formula", "pass", "all"});
  verb.add_option("--duration-s", o->duration_s, "length of the run instead of the config's [s]").above_zero();
  verb.add_option("--gains", o->gains,
                  "gains of a ppd2 law for the running loop, KEY: VALUE; looked at ten times a second");
  verb.add_option("--moves", o->moves, "times the reference is run");
  verb.add_option("--learned", o->learned,
                  "what the moves teach (controller.learning): begun with where FILE is there, written at the end");
  verb.add_option("--record", o->record, "recording, FILE.csv.gz; with several runs FILE-valve.csv.gz and so on");
  verb.add_flag("--force", o->force, "--record may replace recordings that are there");
  verb.add_option("--live", o->live,
                  "live values as JSON over UDP, for PlotJuggler (port 9870); a PORT of this machine, or HOST:PORT");
  verb.add_option("--report", o->report, "self-contained HTML page with plots");
  verb.add_option("--json", o->json, "figures as JSON, - for standard output");
  verb.add_option("--early-wake-us", o->early_wake_us,
                  "real time: wake so long before the slot and watch the clock until it comes; 0: sleep to the slot "
                  "[default: 5 % of the period, at most 50]")
      .within(0.0, 1000.0);
  verb.add_flag("--dump-config", o->dump_config, "print the config with every key, value, unit and range, and stop");
  verb.footer("Three pressure sources and three feedforwards side by side, with a page to look at:\n"
              "  pneuservo run config/cylinder-10m-7.65mm.yaml --pressure-source all --flow-feedforward all --report "
              "run.html\n"
              "On the machine's clock, recorded:\n"
              "  pneuservo run config/cylinder-10m-7.65mm.yaml --time real --duration-s 30 --record run.csv.gz\n"
              "Exit status: 0 done, also when Ctrl-C or another signal ended it early; 1 the run ended in a fault or "
              "its\n"
              "recording is not whole (rows were dropped, its disk is full or hangs); 2 unusable input.");
  verb.callback([o, &status] { status = run(*o); });
}

}  // namespace pneuservo
