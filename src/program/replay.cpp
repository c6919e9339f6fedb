// Verb replay: estimator and controller on recorded measurements; are the outputs those recorded, bit for bit?
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pneuservo/loop/fault.hpp>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "config/same_rig.hpp"
#include "config/version.hpp"
#include "loop/replay.hpp"
#include "pass/learned_move.hpp"
#include "program/output_files.hpp"
#include "program/recorded_kind.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/import.hpp"
#include "record/writer.hpp"
#include "replay/replay_backend.hpp"

namespace pneuservo {
namespace {

struct ReplayOptions {
  std::string config, recording, record, json, learned;
  std::vector<std::string> sets, further;
  bool force = false;
  ExistingFile existing() const { return force ? ExistingFile::replace : ExistingFile::refuse; }
};

/// A number in the header, or what counts without it.
template <class Number>
Number header_number(const Recording& recording, const char* key, Number without) {
  const YAML::Node node = recording.header[key];
  if (node && !YAML::convert<Number>::decode(node, without))
    throw InputError(fmt::format("{}: header: {}: found {}, expected a number", recording.path, key,
                                 node.IsScalar() ? "'" + node.Scalar() + "'" : "no single value"));
  return without;
}

/// Of a column of whole numbers; 0 where it holds another one.
std::uint32_t whole_number(double value) {
  return value >= 0.0 && value <= 4294967295.0 ? static_cast<std::uint32_t>(value) : 0;
}

/// A recording of another period cannot be replayed; one of another config can, and is told. What options of `run` set
/// beside the config, the duration, the pressure source and the feedforward (also the one that a run without a pass
/// went on with), is taken from the recording.
void adopt_header(const Recording& recording, Rig& rig) {
  const double period_s = header_number(recording, "period_s", recording.period_s);
  if (std::isfinite(period_s) && period_s != rig.period_s)
    throw InputError(
        fmt::format("{}: period_s is {}; expected that of the config, {}", recording.path, period_s, rig.period_s));
  const YAML::Node config = recording.header["config"];
  if (!config || !config.IsScalar()) return;
  std::string reason;
  try {
    const Rig recorded = parse_rig(config.Scalar(), recording.path + ", header");
    rig.duration_s = recorded.duration_s;
    if (const auto source = recorded.controller.pressures()) rig.controller.choose_pressures(*source);
    if (rig.controller.is<PdForce>() && recorded.controller.is<PdForce>()) {
      PdForceParameters& law = rig.controller.of<PdForce>();
      const PdForceParameters& ran = recorded.controller.of<PdForce>();
      law.flow_feedforward = ran.flow_feedforward, law.without_pass = ran.without_pass;
    }
    if (same_rig(recorded, rig)) return;
    reason = "was made with another config or other --set";
  } catch (const InputError& error) {
    reason = std::string("holds a config that cannot be read (") + error.what() + ")";
  }
  std::cerr << fmt::format("{}: the recording {}; differences are to be expected\n", recording.path, reason);
}

/// Gains in force at each row, where they were recorded.
std::vector<Ppd2GainSet> gains_of(const Recording& data) {
  constexpr std::array<const char*, 4> names{"position_gain_V_per_m", "velocity_gain_Vs_per_m",
                                             "acceleration_gain_Vs2_per_m", "integral_gain_V_per_m_s"};
  if (!std::all_of(names.begin(), names.end(), [&](const char* name) { return data.has(name); })) return {};
  std::vector<Ppd2GainSet> gains(data.rows());
  for (std::size_t i = 0; i < gains.size(); ++i)
    gains[i] = {data.column(names[0])[i], data.column(names[1])[i], data.column(names[2])[i], data.column(names[3])[i]};
  return gains;
}

/// What a commanded axis obeyed in each row; nothing of a run along a reference.
std::vector<AxisCommand> commands_of(const Recording& data, int moves, bool is_pressure) {
  if (moves > 0 || !data.has("command_kind")) return {};
  std::vector<AxisCommand> commands(data.rows());
  for (std::size_t i = 0; i < commands.size(); ++i) {
    commands[i].kind = static_cast<CommandKind>(whole_number(data.column("command_kind")[i]));
    commands[i].target = data.column(is_pressure ? "command_Pa" : "command_m")[i];
    commands[i].rate = data.column(is_pressure ? "command_Pa_per_s" : "command_mps")[i];
    if (data.has("command_s")) commands[i].interval_s = data.column("command_s")[i];
  }
  return commands;
}

using RecordedColumns = std::vector<std::pair<std::string, const std::vector<double>*>>;

/// Columns of estimator and controller that a recording has, to compare with.
RecordedColumns compared_columns(const ReplayOptions& options, const Rig& rig, const Recording& data) {
  RecordedColumns recorded;
  for (const std::string& name : replayed_columns(rig.controller.kind))
    if (data.has(name)) recorded.emplace_back(name, &data.column(name));
  if (recorded.empty() && (is_own_format(data) || options.record.empty()))
    throw InputError(
        options.recording +
        ": no column of estimator or controller to compare, expected p1_estimated_Pa, p2_estimated_Pa or u_V");
  return recorded;
}

/// Replays all rows with the gains that were in force.
ReplayResult replay_rows(const Rig& rig, ReplayBackend& backend, int moves, const RecordedColumns& recorded,
                         const std::string& learned_path) {
  const Recording& data = backend.recording();
  std::vector<std::int64_t> ticks;
  std::vector<std::uint32_t> flags;
  const std::vector<double>* recorded_flags = data.has("flags") ? &data.column("flags") : nullptr;
  for (std::size_t i = 0; i < backend.rows(); ++i) {
    ticks.push_back(backend.tick(i));
    flags.push_back(recorded_flags != nullptr ? whole_number((*recorded_flags)[i]) : 0);
  }
  backend.configure();
  backend.activate();
  LoadLearned learned;
  if (!learned_path.empty()) learned = [&](const RepeatedMove& move) { return read_learned_move(learned_path, move); };
  ReplayResult result = replay_loop(rig, backend, ticks, flags, moves, load_reference_positions, recorded,
                                    gains_of(data), commands_of(data, moves, rig.controls_pressure()), learned);
  backend.deactivate();
  return result;
}

/// " V" of u_V, " m/s" of v_mps; nothing of a name without a unit, or of one that has it in full (V_per_m).
std::string unit_of(const std::string& column) {
  if (column.find("_per_") != std::string::npos) return "";
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> units{{{"_Pa", "Pa"},
                                                                                {"_kgps", "kg/s"},
                                                                                {"_mps", "m/s"},
                                                                                {"_Ns", "N s"},
                                                                                {"_m", "m"},
                                                                                {"_N", "N"},
                                                                                {"_V", "V"},
                                                                                {"_s", "s"}}};
  for (const auto& [ending, unit] : units)
    if (column.ends_with(ending)) return fmt::format(" {}", unit);
  return "";
}

/// Why numbers differ, as far as the header tells.
std::string reason_text(const Recording& recording) {
  if (!is_own_format(recording))
    return "another logger rounds what it writes: only the largest differences say something\n";
  const auto recorded = [&](const char* key) {
    const YAML::Node node = recording.header[key];
    return node && node.IsScalar() ? node.as<std::string>() : std::string("unknown");
  };
  const std::string version_was = recorded("version"), path_was = recorded("code_path");
  if (version_was == version() && path_was == code_path())
    return "version and code path are those of the recording: another config, another C library or another build of "
           "this version computes other numbers\n";
  return fmt::format("recorded by version {} on code path {}, replayed by version {} on code path {}\n", version_was,
                     path_was, version(), code_path());
}

/// "motion_deviation, speed" of the bits; "none" of none.
std::string fault_names(std::uint64_t faults) {
  std::vector<std::string_view> names;
  for (const FaultText& text : fault_texts)
    if ((faults & text.bit) != 0) names.push_back(text.name);
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

/// The faults of the compared rows: what was recorded and what came now. Bits are no number to take a difference of.
std::string faults_text(const ReplayResult& result, const Recording& data) {
  const std::vector<double>& column = data.column("fault");
  std::uint64_t recorded = 0, replayed = 0;
  for (std::size_t i = 0; i < result.compared_rows; ++i) {
    if (std::isfinite(column[i]) && column[i] > 0) recorded |= static_cast<std::uint64_t>(column[i]);
    replayed |= result.rows[i].fault;
  }
  return fmt::format("  {:<18} recorded {}, replayed {}\n", "fault", fault_names(recorded), fault_names(replayed));
}

/// Whether the numbers are the recorded ones, and of each column that differs by how much.
std::string result_text(const ReplayResult& result, const ReplayBackend& backend) {
  const std::size_t columns = result.compared.size();
  std::string text = fmt::format("{} of {} rows replayed, {} column{} compared: ", result.compared_rows, backend.rows(),
                                 columns, columns == 1 ? "" : "s");
  text += result.identical() ? "bit for bit as recorded\n" : fmt::format("{} values differ\n", result.differing_values);
  if (!result.end.empty()) text += fmt::format("not to the last row: {}\n", result.end);
  if (!result.first) return text;
  const std::string unit = unit_of(result.first->column);
  text +=
      fmt::format("first: row {} (t = {} s), {}: recorded {}{}, replayed {}{}\n", result.first->row, result.first->t_s,
                  result.first->column, result.first->recorded, unit, result.first->replayed, unit);
  for (std::size_t i = 0; i < columns; ++i) {
    if (result.largest_difference[i] == 0 && result.one_sided[i] == 0) continue;
    if (result.compared[i] == "fault") {
      text += faults_text(result, backend.recording());
      continue;
    }
    const std::string one_sided =
        result.one_sided[i] > 0 ? fmt::format(", {} values that only one of both has", result.one_sided[i]) : "";
    text += fmt::format("  {:<18} largest difference {:.3g}{}{}\n", result.compared[i], result.largest_difference[i],
                        unit_of(result.compared[i]), one_sided);
  }
  return text + reason_text(backend.recording());
}

nlohmann::ordered_json result_json(const Rig& rig, const ReplayOptions& options, const ReplayResult& result,
                                   std::size_t rows) {
  nlohmann::ordered_json json{{"config", rig.name},
                              {"recording", options.recording},
                              {"rows", rows},
                              {"compared_rows", result.compared_rows},
                              {"identical", result.identical()},
                              {"differing_values", result.differing_values}};
  if (result.first)
    for (std::size_t i = 0; i < result.compared.size(); ++i)
      json["largest_difference"][result.compared[i]] = result.largest_difference[i];
  return json;
}

/// The next file of a series that `serve` wrote, behind what came before it.
void append_part(Recording& all, const Recording& part) {
  if (part.names != all.names)
    throw InputError(part.path + ": found other columns than in " + all.path +
                     ", expected the next file of the same run");
  const double step_s = part.t_s().front() - all.t_s().back();
  if (!(step_s > 0.0))
    throw InputError(fmt::format("{}: begins {:g} s before the end of the file before it, expected files of one run",
                                 part.path, -step_s));
  for (std::size_t i = 0; i < all.values.size(); ++i)
    all.values[i].insert(all.values[i].end(), part.values[i].begin(), part.values[i].end());
  all.line_numbers.insert(all.line_numbers.end(), part.line_numbers.begin(), part.line_numbers.end());
}

/// The files of one run, in the order of their times.
Recording read_parts(const ReplayOptions& options, const Rig& rig) {
  std::vector<Recording> parts;
  parts.push_back(read_first_recording(options.recording, rig.imported, rig.period_s));
  for (const std::string& path : options.further) parts.push_back(read_recording(path));
  std::ranges::sort(parts, {}, [](const Recording& part) { return part.t_s().front(); });
  for (const Recording& part : parts)
    for (const auto& line : problem_lines(part)) std::cerr << line << "\n";
  Recording all = std::move(parts.front());
  for (std::size_t i = 1; i < parts.size(); ++i) append_part(all, parts[i]);
  return all;
}

int run_replay(const ReplayOptions& options) {
  Rig rig = read_rig(options.config, options.sets);
  require_loop("replay", options.config, rig);
  OutputFiles()
      .reads("CONFIG", options.config)
      .reads_of(rig)
      .reads("RECORDING", options.recording)
      .reads("FURTHER", options.further)
      .reads("--learned", options.learned)
      .records("--record", options.record, options.existing())
      .writes("--json", options.json, ResultKind::json);
  Recording recording = read_parts(options, rig);
  require_same_kind(recording, options.config, rig);
  adopt_header(recording, rig);
  const int moves = header_number(recording, "moves", 1);
  auto backend = rig.controls_pressure() ? ReplayBackend(std::move(recording), rig.period_s, {Signal::p1_port})
                                         : ReplayBackend(std::move(recording), rig.period_s);
  const bool is_foreign = !is_own_format(backend.recording());
  const ReplayResult result =
      replay_rows(rig, backend, moves, compared_columns(options, rig, backend.recording()), options.learned);

  if (options.json != "-") std::cout << result_text(result, backend);
  write_json(options.json, result_json(rig, options, result, backend.rows()));
  if (!options.record.empty()) {
    RecordingWriter writer(options.record, run_header(rig, backend, machine_facts(nullptr), moves), {},
                           {.existing = options.existing(), .terms = law_columns(rig.controller.kind)});
    for (const Row& row : result.rows) writer.write(row);
    const RecordingSummary summary = writer.close();
    if (!summary.error.empty()) throw InputError(summary.error);
  }
  return result.identical() || is_foreign ? 0 : 1;
}

}  // namespace

void add_replay(CommandLine& app, int& status) {
  auto o = std::make_shared<ReplayOptions>();
  Verb verb = app.add_verb("replay", "run estimator and controller on a recording and compare bit for bit");
  verb.add_option("CONFIG", o->config, "the config that the recording was made with").required();
  verb.add_option("RECORDING", o->recording, "FILE.csv.gz").required();
  verb.add_option("FURTHER", o->further, "the other files of a run of serve");
  add_set_option(verb, o->sets);
  verb.add_option("--record", o->record, "write what was replayed, FILE.csv.gz");
  verb.add_flag("--force", o->force, "--record may replace a recording that is there");
  verb.add_option("--learned", o->learned, "what a run that learns moves began with, FILE.before of its --learned");
  verb.add_option("--json", o->json, "result as JSON, - for standard output");
  verb.footer("Exit status: 0 identical, 1 something differs, 2 unusable input.");
  verb.callback([o, &status] { status = run_replay(*o); });
}

}  // namespace pneuservo
