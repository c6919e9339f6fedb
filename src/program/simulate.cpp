// Verb simulate: the plant alone on a recorded command, beside what was measured.
#include <cmath>
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "diagnosis/doubts/recording_doubts.hpp"
#include "program/output_files.hpp"
#include "program/recorded_kind.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/import.hpp"
#include "record/writer.hpp"
#include "sim/plant_course.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {
namespace {

struct SimulateOptions {
  std::string config, command, record, json;
  std::vector<std::string> sets;
  bool force = false;
  ExistingFile existing() const { return force ? ExistingFile::replace : ExistingFile::refuse; }
};

Row row_of(const Rig& rig, const Recording& recording, const PlantCourse& course, std::size_t i) {
  Row row;
  row.t_s = recording.t_s()[i];
  for (const Signal signal : channel_signals) row.measured[signal] = course.measured[signal][i];
  if (!rig.controls_pressure()) row.x_true_m = row.measured[Signal::x];
  row.p1_chamber_true_Pa = row.measured[Signal::p1_chamber];
  row.p2_chamber_true_Pa = row.measured[Signal::p2_chamber];
  row.v_mps = course.v_mps[i];
  if (rig.valves() == 1) row.u_V = course.u1_V[i];
  else row.u1_V = course.u1_V[i], row.u2_V = course.u2_V[i];
  return row;
}

struct Difference {
  std::string column;
  double rms = 0.0, maximum = 0.0;
};

std::vector<Difference> differences(const Recording& recording, const PlantCourse& course) {
  std::vector<Difference> out;
  for (const Signal signal : channel_signals) {
    const std::string_view name = info(signal).column;
    if (!recording.has(name)) continue;
    Difference d{.column = std::string(name)};
    std::size_t counted = 0;
    for (std::size_t i = 0; i < recording.rows(); ++i) {
      const double e = course.measured[signal][i] - recording.column(name)[i];
      if (!std::isfinite(e)) continue;
      d.rms += e * e;
      d.maximum = std::max(d.maximum, std::fabs(e));
      ++counted;
    }
    d.rms = counted > 0 ? std::sqrt(d.rms / static_cast<double>(counted)) : Row::none;
    out.push_back(d);
  }
  return out;
}

/// A foreign recording is doubted as `diagnose` doubts it: what is certain is corrected, and all of it told.
Recording doubted(const Rig& rig, Recording recording) {
  if (is_own_format(recording)) return recording;
  Rig judge = rig;
  std::vector<Recording> judged{recording};
  std::vector<std::string> notes;
  try {
    doubt_recordings(judge, judged, notes);
    recording = std::move(judged.front());
  } catch (const InputError& asked) { notes.emplace_back(asked.what()); }
  for (const std::string& note : notes) std::cerr << "doubt: " << note << "\n";
  return recording;
}

int run_simulate(const SimulateOptions& options) {
  const Rig rig = read_rig(options.config, options.sets);
  require_loop("simulate", options.config, rig);
  OutputFiles()
      .reads("CONFIG", options.config)
      .reads_of(rig)
      .reads("--command", options.command)
      .records("--record", options.record, options.existing())
      .writes("--json", options.json, ResultKind::json);
  const Recording recording = doubted(rig, read_first_recording(options.command, rig.imported, rig.period_s));
  for (const auto& line : problem_lines(recording)) std::cerr << line << "\n";
  require_same_kind(recording, options.config, rig);
  const PlantCourse course = simulate_plant(rig, recording);
  nlohmann::ordered_json json{{"config", rig.name}, {"command", options.command}, {"rows", recording.rows()}};
  std::string text =
      fmt::format("{} rows simulated on the recorded command; simulated minus recorded:\n  {:<16} {:>12} {:>12}\n",
                  recording.rows(), "column", "rms", "max");
  for (const Difference& d : differences(recording, course)) {
    text += fmt::format("  {:<16} {:>12.6g} {:>12.6g}\n", d.column, d.rms, d.maximum);
    json["difference"][d.column] = {{"rms", d.rms}, {"max", d.maximum}};
  }
  if (options.json != "-") std::cout << text;
  write_json(options.json, json);
  if (!options.record.empty()) {
    SimBackend backend(rig);
    std::vector<std::string> columns = command_columns(rig);
    columns.emplace_back("t_s");
    if (!rig.controls_pressure()) columns.emplace_back("v_mps");
    for (const Signal signal : channel_signals)
      if (rig.has_sensor(signal)) columns.emplace_back(info(signal).column);
    RecordingWriter writer(options.record, run_header(rig, backend, machine_facts(nullptr), 1), columns,
                           {.existing = options.existing()});
    for (std::size_t i = 0; i < recording.rows(); ++i) writer.write(row_of(rig, recording, course, i));
    const RecordingSummary summary = writer.close();
    if (!summary.error.empty()) throw InputError(summary.error);
  }
  return 0;
}

}  // namespace

void add_simulate(CommandLine& app, int& status) {
  auto o = std::make_shared<SimulateOptions>();
  Verb verb = app.add_verb("simulate", "simulate the plant alone on a recorded command");
  verb.add_option("CONFIG", o->config, "rig to simulate").required();
  verb.add_option("--command", o->command, "recording with the column u_V, of a servo table u1_V and u2_V").required();
  add_set_option(verb, o->sets);
  verb.add_option("--record", o->record, "what was simulated, without sensor noise, FILE.csv.gz");
  verb.add_flag("--force", o->force, "--record may replace a recording that is there");
  verb.add_option("--json", o->json, "differences from the recording as JSON, - for standard output");
  verb.footer(
      "The plant starts at the recording's first position and pressures, at rest. A free position drifts: small flow\n"
      "errors add up; compare pressures first.");
  verb.callback([o, &status] { status = run_simulate(*o); });
}

}  // namespace pneuservo
