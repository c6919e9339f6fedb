// Verb import: what the program understands of a foreign recording, and the section of a config that says so.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "diagnosis/doubts/recording_doubts.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/column_guess.hpp"
#include "record/import.hpp"
#include "record/names_text.hpp"
#include "report/import_report.hpp"

namespace pneuservo {
namespace {

struct ImportOptions {
  std::string recording, config, report, json, write;
  std::vector<std::string> sets;
  bool force = false;
};

/// Columns by the config's own map, where it has one.
std::vector<ColumnGuess> mapped_columns(const CsvTable& table, const ImportParameters& map) {
  std::vector<ColumnGuess> out;
  for (const std::string& name : table.names) {
    out.push_back({name, "", "", 1, 0, "not in the config's section import"});
    for (const auto& [ours, source] : map.columns)
      if (source.column == name)
        out.back() = {name, ours, "", source.factor, source.offset, "import.columns of the config"};
    if (name == "t_s" && map.columns.count("t_s") == 0) out.back() = {name, "t_s", "", 1, 0, "its name"};
  }
  return out;
}

/// Columns that `diagnose` compares nothing without, of a rig that has no column in the file for them.
std::vector<std::string> missing_columns(const Rig& rig, const Recording& recording) {
  std::vector<std::string> wanted{"x_m"}, missing;
  if (rig.is_pneumatic()) {
    for (const std::string& command : command_columns(rig)) wanted.push_back(command);
    for (const Signal port : port_signals) wanted.emplace_back(info(port).column);
  } else if (!rig.has_controller()) {
    return {};  // a column of several serves there
  }
  std::ranges::copy_if(wanted, std::back_inserter(missing),
                       [&](const std::string& name) { return !recording.has(name); });
  return missing;
}

/// What the user has to state, with the columns of the file that nothing was taken from.
void tell_missing(const Rig& rig, ImportResult& result) {
  const std::vector<std::string> missing = missing_columns(rig, result.runs.front());
  if (missing.empty()) return;
  std::vector<std::string> untaken;
  for (const ColumnGuess& guess : result.columns)
    if (guess.ours.empty())
      untaken.push_back(guess.unit.empty() || guess.column.find(guess.unit) != std::string::npos
                            ? guess.column
                            : fmt::format("{} [{}]", guess.column, guess.unit));
  for (const std::string& name : missing)
    result.doubts.push_back(fmt::format("{0}: found no column for it, expected one: state it, "
                                        "import: {{columns: {{{0}: {{column: \"...\", factor: 1, offset: 0}}}}}}{1}",
                                        name, untaken.empty() ? "" : "; not taken are " + names_text(untaken)));
}

ImportResult understood(const ImportOptions& options, std::optional<Rig> rig) {
  CsvTable table = read_table(options.recording);
  ImportResult out;
  out.path = options.recording;
  const double loop_period_s = rig ? rig->period_s : std::numeric_limits<double>::quiet_NaN();
  if (rig && rig->imported) {
    out.columns = mapped_columns(table, *rig->imported);
    out.runs = recordings_in(std::move(table), rig->imported, loop_period_s);
  } else {
    out.columns = guess_columns(table, rig ? rig->axis.air.atmosphere_Pa : 101325.0);
    const ImportParameters map = import_map(out.columns);
    if (map.columns.count("t_s") == 0)
      throw InputError(
          fmt::format("{}: found no column of times, expected one such as t_s, time_ms or a date, or one that "
                      "counts the rows, with their interval as its factor; the file has {}",
                      options.recording, names_text(table.names)));
    const bool is_own = is_own_format(table);
    out.runs = recordings_in(std::move(table), is_own ? std::nullopt : std::optional(map), loop_period_s);
  }
  ImportParameters map = rig && rig->imported ? *rig->imported : import_map(out.columns);
  for (const Recording& run : out.runs)
    for (const std::string& line : problem_lines(run)) out.understood.push_back(line);
  if (rig) {
    std::vector<Recording> judged = out.runs;
    try {
      doubt_recordings(*rig, judged, out.doubts);
    } catch (const InputError& asked) { out.doubts.emplace_back(asked.what()); }
    // What was certain stands in the section; the first run speaks for the file.
    for (auto& [name, source] : map.columns) {
      const bool tells_runs = source.tells_runs;
      if (judged.front().has(name) && !is_own_format(judged.front())) source = source_of(judged.front(), name);
      source.tells_runs = tells_runs;
    }
  }
  if (rig) tell_missing(*rig, out);
  out.section = import_section(map, out.columns);
  return out;
}

nlohmann::ordered_json import_json(const ImportResult& result) {
  nlohmann::ordered_json columns = nlohmann::ordered_json::array(), runs = nlohmann::ordered_json::array();
  for (const ColumnGuess& guess : result.columns)
    columns.push_back({{"column", guess.column},
                       {"taken_for", guess.ours},
                       {"unit", guess.unit},
                       {"factor", guess.factor},
                       {"offset", guess.offset},
                       {"evidence", guess.evidence}});
  for (const Recording& run : result.runs)
    runs.push_back({{"rows", run.rows()},
                    {"from_s", run.t_s().front()},
                    {"to_s", run.t_s().back()},
                    {"interval_s", run.period_s},
                    {"missing_rows", run.missing_rows}});
  return {{"recording", result.path},        {"columns", columns},      {"runs", runs},
          {"understood", result.understood}, {"doubts", result.doubts}, {"import", result.section}};
}

/// A config's text without its section import: from that key to the next one of the top level.
std::string without_section(const std::string& config) {
  std::istringstream lines(config);
  std::string out;
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    const bool is_key = !line.empty() && line[0] != ' ' && line[0] != '\t' && line[0] != '#';
    if (is_key) inside = line.starts_with("import:");
    if (!inside) out += line + "\n";
  }
  return out;
}

/// The config with the section behind it, in place of one that it has, or the section alone.
void write_section(const ImportOptions& options, const ImportResult& result) {
  if (options.write.empty()) return;
  std::string text;
  if (!options.config.empty()) {
    std::ifstream in(options.config);
    std::ostringstream all;
    all << in.rdbuf();
    text = without_section(all.str());
  }
  if (!text.starts_with(import_mark)) text = std::string(import_mark) + "\n" + text;
  if (!text.ends_with('\n')) text += '\n';
  text += result.section;
  write_result(options.write, text);
}

int run_import(const ImportOptions& options) {
  std::optional<Rig> rig;
  if (!options.config.empty()) rig = read_rig(options.config, options.sets);
  OutputFiles()
      .reads("FILE", options.recording)
      .reads("CONFIG", options.config)
      .writes("--json", options.json, ResultKind::json)
      .writes("--report", options.report, ResultKind::page)
      .writes("--write", options.write, ResultKind::import_section,
              options.force ? ExistingFile::replace : ExistingFile::refuse);
  const ImportResult result = understood(options, rig);
  if (options.json != "-") {
    std::cout << text_table(import_table(result)) << "\n" << text_table(runs_table(result));
    for (const std::string& line : result.understood) std::cout << line << "\n";
    for (const std::string& line : result.doubts) std::cout << "doubt: " << line << "\n";
    if (options.write.empty()) std::cout << "\n" << result.section;
  }
  write_json(options.json, import_json(result));
  if (!options.report.empty()) write_import_report(result, options.report);
  write_section(options, result);
  for (const std::string& written : {options.report, options.write})
    if (!written.empty() && options.json != "-") std::cout << "written: " << written << "\n";
  return 0;
}

}  // namespace

void add_import(CommandLine& app, int& status) {
  auto o = std::make_shared<ImportOptions>();
  Verb verb = app.add_verb("import", "what is understood of a foreign recording: columns, units, times, gaps");
  verb.add_option("FILE", o->recording, "a table of any logger, .csv or .csv.gz").required();
  verb.add_option("CONFIG", o->config, "rig whose ranges and physics doubt the recording");
  verb.add_option("--report", o->report, "self-contained HTML page with the channels over time");
  verb.add_option("--json", o->json, "result as JSON, - for standard output");
  verb.add_option("--write", o->write, "OUT.yaml: the config with a section import, or the section alone");
  verb.add_flag("--force", o->force, "replaces an older result of import");
  add_set_option(verb, o->sets);
  verb.footer("Quantities and units are guessed from names, brackets and a row of units; each line says by what.");
  verb.callback([o, &status] { status = run_import(*o); });
}

}  // namespace pneuservo
