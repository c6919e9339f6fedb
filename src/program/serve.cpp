// Verb serve: an axis that runs until it is told otherwise and moves as it is commanded.
#include <filesystem>
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "backends.hpp"
#include "config/input_error.hpp"
#include "drive/drive_objects.hpp"
#include "loop/device_grade.hpp"
#include "loop/realtime_stop.hpp"
#include "loop/runner.hpp"
#include "loop/safe_output_text.hpp"
#include "program/axis_options.hpp"
#include "program/injection.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/served_drive.hpp"
#include "program/verbs.hpp"
#include "record/result_file.hpp"
#include "record/series.hpp"
#include "record/writer.hpp"
#include "service/command_server.hpp"
#include "service/sockets.hpp"

namespace pneuservo {
namespace {

struct ServeOptions : AxisOptions {
  ServeOptions() { time = "real"; }
  std::string socket, record, eds;
};

/// Hours of injected faults that come again and again; nobody serves a simulation for longer.
constexpr double longest_injection_s = 1e5;

Rig read_with_options(const ServeOptions& options) {
  Rig rig = read_axis("serve", options);
  const bool is_pressure = rig.controls_pressure();
  if (is_pressure ? rig.pressure_reference.kind != PressureReferenceKind::live
                  : rig.reference.kind != ReferenceKind::live)
    throw InputError(fmt::format("{}: reference.kind: found a reference that is fixed, expected live, with {} "
                                 "(docs/serve.md)",
                                 options.config,
                                 is_pressure ? "lowest_Pa, highest_Pa and rate_Pa_per_s"
                                             : "lowest_m, highest_m, speed_mps and acceleration_mps2"));
  if (!rig.serve) rig.serve.emplace();
  return rig;
}

/// Of the config's name: axis.yaml is served as axis.
std::string axis_name(const ServeOptions& options) { return std::filesystem::path(options.config).stem().string(); }

std::filesystem::path socket_of(const ServeOptions& options) {
  if (!options.socket.empty()) return options.socket;
  const std::filesystem::path folder = socket_folder();
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  return folder / (axis_name(options) + ".sock");
}

std::shared_ptr<RecordingSeries> series_of(const ServeOptions& options, const ServeParameters& serve,
                                           const std::string& stem) {
  if (options.record.empty()) return nullptr;
  return std::make_shared<RecordingSeries>(SeriesSettings{.folder = options.record,
                                                          .stem = stem,
                                                          .part_s = serve.part_s,
                                                          .budget_MB = serve.recordings_MB,
                                                          .kept_MB = serve.kept_MB,
                                                          .around_s = serve.around_s});
}

std::unique_ptr<RecordingWriter> open_recording(const Rig& rig, const Backend& backend, const Facts& machine,
                                                bool real_time, const std::shared_ptr<RecordingSeries>& series) {
  if (!series) return nullptr;
  RecordingOptions recording{.terms = law_columns(rig.controller.kind), .series = series};
  if (real_time) recording.ring = std::make_shared<RecordingRing>();
  return std::make_unique<RecordingWriter>("", run_header(rig, backend, machine, 0),
                                           recorded_columns(rig, backend, {.real_time = real_time, .commanded = true}),
                                           std::move(recording));
}

/// What a PLC's tool reads of the drive; nothing is served.
int write_eds(const ServeOptions& options) {
  const Rig rig = read_with_options(options);
  if (!rig.serve->drive)
    throw InputError(options.config +
                     ": serve.drive: found nothing, expected the drive's interface and node_id (docs/drive.md)");
  OutputFiles().reads("CONFIG", options.config).writes("--eds", options.eds, ResultKind::eds);
  write_result(options.eds, drive_eds(rig));
  return 0;
}

/// What is to be told at the end. True: the recording is whole.
bool close_all(const Rig& rig, const Backend& backend, const RunOutcome& outcome, RecordingWriter* writer) {
  for (const std::string& note : backend.notes()) std::cerr << note << "\n";
  if (outcome.stopped_by_signal) std::cerr << "stopped by " << StopRequest::signal_name() << ": ";
  std::cerr << safe_output_text(backend.safe_output(), rig) << "\n";
  for (const std::string& fault : outcome.faults) std::cerr << "latched: " << fault << "\n";
  if (writer == nullptr) return true;
  const RecordingSummary summary = writer->close();
  if (summary.dropped > 0)
    std::cerr << fmt::format("{} rows were dropped, the writer came too late\n", summary.dropped);
  if (!summary.error.empty()) std::cerr << summary.error << "\n";
  return summary.whole();
}

int serve(const ServeOptions& options) {
  if (!options.eds.empty()) return write_eds(options);
  const Rig rig = read_with_options(options);
  const bool real_time = options.real_time();
  heed_axis(options, rig);
  StopRequest stop;
  const std::unique_ptr<RealTimeSession> session = realtime_session(options);
  if (session) std::cerr << refusal_message(session->findings());
  const auto faults = injected_faults(options.scenarios, options.faults, rig);
  const auto backend = make_faulty_backend(backend_of(options, rig), rig, faults);
  if (backend->name() == "configured") std::cerr << device_warning(rig);
  backend->configure();
  const std::string stem = axis_name(options) + "-" + utc_stamp();
  const auto series = series_of(options, *rig.serve, stem);
  const auto link = std::make_unique<CommandLink>();
  const std::filesystem::path socket = socket_of(options);
  const auto drive = rig.serve->drive ? std::make_unique<ServedDrive>(rig) : nullptr;
  const auto say = [](const std::string& line) { std::cerr << line + "\n"; };
  CommandServer server(rig, socket, *link, series.get(), say);
  const auto writer =
      open_recording(rig, *backend, machine_facts(session ? &session->state() : nullptr), real_time, series);
  if (drive) server.add(drive->commander());
  server.start();
  if (drive) drive->start();
  if (drive) std::cerr << fmt::format("a CiA 402 drive is {}\n", drive->name());
  std::cerr << fmt::format("commands at {}; nothing moves before the command enable; Ctrl-C ends\n", socket.string());
  const RunOutcome outcome = run_loop(rig, *backend,
                                      {.real_time = real_time,
                                       .moves = 0,
                                       .ring = writer ? writer->ring() : nullptr,
                                       .writer = real_time ? nullptr : writer.get(),
                                       .recording = series ? options.record + "/" + stem + ".csv.gz" : std::string(),
                                       .commands = link.get(),
                                       .say = say,
                                       .late = late_ticks(faults, rig.period_s, longest_injection_s),
                                       .suspends = suspends(faults, rig.period_s)});
  const bool whole = close_all(rig, *backend, outcome, writer.get());
  StopRequest::let_go(StopRequest::patience_s);
  return outcome.faults.empty() && whole ? 0 : 1;
}

}  // namespace

void add_serve(CommandLine& app, int& status) {
  auto o = std::make_shared<ServeOptions>();
  Verb verb = app.add_verb("serve", "runs an axis that moves as it is commanded, until it is stopped");
  add_axis_options(verb, *o, "rig with a reference of kind live, e.g. config/served/cylinder-10m-7.65mm.yaml");
  verb.add_option("--socket", o->socket,
                  "Unix socket for commands [default: CONFIG's name.sock in $RUNTIME_DIRECTORY or "
                  "$XDG_RUNTIME_DIR/pneuservo]");
  verb.add_option("--record", o->record, "folder for recordings: files of serve.part_s, the oldest go");
  verb.add_option("--eds", o->eds, "write the EDS of the drive (serve.drive) into FILE, serve nothing")
      .type_name("FILE");
  verb.footer(
      "In one terminal, and then in another:\n"
      "  pneuservo serve config/served/cylinder-10m-7.65mm.yaml --socket axis.sock\n"
      "  pneuservo command enable --socket axis.sock\n"
      "  pneuservo command move 0.1 --speed 0.2 --socket axis.sock\n"
      "Exit status: 0 stopped by a signal; 1 a fault was latched then, or the recording is not whole; 2 unusable\n"
      "input.");
  verb.callback([o, &status] { status = serve(*o); });
}

}  // namespace pneuservo
