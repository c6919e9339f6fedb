// Verb simulate: the plant alone on a recorded command, beside what was measured.
#include <cmath>
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/rig/plant.hpp>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "diagnosis/doubts/recording_doubts.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/import.hpp"
#include "record/writer.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {
namespace {

struct SimulateOptions {
  std::string config, command, record, json;
  std::vector<std::string> sets;
  bool force = false;
  ExistingFile existing() const { return force ? ExistingFile::replace : ExistingFile::refuse; }
};

/// First value of the first of these columns that is there and holds one; else the fallback.
double first_value(const Recording& recording, std::initializer_list<std::string_view> names, double fallback) {
  for (const std::string_view name : names)
    if (recording.has(name) && std::isfinite(recording.column(name).front())) return recording.column(name).front();
  return fallback;
}

/// The recording's own start: at rest, each line at its chamber's pressure.
PlantStart<double> recorded_start(const Rig& rig, const Recording& recording) {
  const PlantStart<double> own = plant_start(rig);
  return {first_value(recording, {"x_true_m", info(Signal::x).column}, own.position_m),
          first_value(recording, {"p1_chamber_true_Pa", info(Signal::p1_chamber).column, info(Signal::p1_port).column},
                      own.pressure_1_Pa),
          first_value(recording, {"p2_chamber_true_Pa", info(Signal::p2_chamber).column, info(Signal::p2_port).column},
                      own.pressure_2_Pa)};
}

/// A command that is held for longer than the axis takes for its whole stroke says nothing of where it stands.
void refuse_long_gaps(const Rig& rig, const Recording& recording) {
  const double longest_s = AxisLoop::longest_approach_s(rig.axis.cylinder.stroke_m);
  const std::vector<double>& t_s = recording.t_s();
  for (std::size_t i = 1; i < t_s.size(); ++i)
    if (t_s[i] - t_s[i - 1] > longest_s)
      throw InputError(
          fmt::format("{}, line {}: t_s goes from {} to {}, a gap of {:.6g} s without a command, expected at most "
                      "{:.3g} s, in which "
                      "the axis crosses its stroke: give the rows before or after it as a recording of their own",
                      recording.path, recording.line_numbers[i], t_s[i - 1], t_s[i], t_s[i] - t_s[i - 1], longest_s));
}

std::vector<Row> simulate_plant(const Rig& rig, const Recording& recording) {
  const std::vector<std::string> names = command_columns(rig);
  const auto &command_1 = recording.column(names.front()), &command_2 = recording.column(names.back());
  AxisPlant<double> plant;
  plant.configure(rig.axis, rig.period_s, rig.simulation.cells_per_m, valve_arrangement(rig));
  plant.reset(recorded_start(rig, recording));
  std::vector<Row> rows(recording.rows());
  double held_1_V = 0.0, held_2_V = 0.0;
  std::int64_t tick = std::llround(recording.t_s().front() / rig.period_s);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const std::int64_t due = std::llround(recording.t_s()[i] / rig.period_s); tick < due; ++tick)
      plant.step(held_1_V, held_2_V);
    if (std::isfinite(command_1[i])) held_1_V = command_1[i];
    if (std::isfinite(command_2[i])) held_2_V = command_2[i];
    Row& row = rows[i];
    row.t_s = recording.t_s()[i];
    row.measured = true_values(plant);
    row.x_true_m = row.measured[Signal::x];
    row.p1_chamber_true_Pa = row.measured[Signal::p1_chamber];
    row.p2_chamber_true_Pa = row.measured[Signal::p2_chamber];
    row.v_mps = plant.velocity();
    if (names.size() == 1) row.u_V = held_1_V;
    else row.u1_V = held_1_V, row.u2_V = held_2_V;
  }
  return rows;
}

struct Difference {
  std::string column;
  double rms = 0.0, maximum = 0.0;
};

std::vector<Difference> differences(const Recording& recording, const std::vector<Row>& rows) {
  std::vector<Difference> out;
  for (const Signal signal : channel_signals) {
    const std::string_view name = info(signal).column;
    if (!recording.has(name)) continue;
    Difference d{.column = std::string(name)};
    std::size_t counted = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double e = rows[i].measured[signal] - recording.column(name)[i];
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
  require_valves("simulate", options.config, rig);
  OutputFiles()
      .reads("CONFIG", options.config)
      .reads_of(rig)
      .reads("--command", options.command)
      .records("--record", options.record, options.existing())
      .writes("--json", options.json, ResultKind::json);
  const Recording recording = doubted(rig, read_first_recording(options.command, rig.imported, rig.period_s));
  for (const auto& line : problem_lines(recording)) std::cerr << line << "\n";
  recording.require(command_columns(rig));
  refuse_long_gaps(rig, recording);
  const std::vector<Row> rows = simulate_plant(rig, recording);
  nlohmann::ordered_json json{{"config", rig.name}, {"command", options.command}, {"rows", rows.size()}};
  std::string text =
      fmt::format("{} rows simulated on the recorded command; simulated minus recorded:\n  {:<16} {:>12} {:>12}\n",
                  rows.size(), "column", "rms", "max");
  for (const Difference& d : differences(recording, rows)) {
    text += fmt::format("  {:<16} {:>12.6g} {:>12.6g}\n", d.column, d.rms, d.maximum);
    json["difference"][d.column] = {{"rms", d.rms}, {"max", d.maximum}};
  }
  if (options.json != "-") std::cout << text;
  write_json(options.json, json);
  if (!options.record.empty()) {
    SimBackend backend(rig);
    std::vector<std::string> columns = command_columns(rig);
    columns.insert(columns.end(), {"t_s", "v_mps"});
    for (const Signal signal : channel_signals) columns.emplace_back(info(signal).column);
    RecordingWriter writer(options.record, run_header(rig, backend, machine_facts(nullptr), 1), columns,
                           {.existing = options.existing()});
    for (const Row& row : rows) writer.write(row);
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
