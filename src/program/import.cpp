// Verb import: what the program understands of a foreign recording, and the section of a config that says so.
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>

#include <CLI/CLI.hpp>
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

/// The config with the section behind it, or the section alone.
void write_section(const ImportOptions& options, const ImportResult& result, bool has_section) {
  if (options.write.empty()) return;
  std::string text;
  if (!options.config.empty()) {
    std::ifstream in(options.config);
    std::ostringstream all;
    all << in.rdbuf();
    text = all.str();
  }
  if (!text.starts_with(import_mark)) text = std::string(import_mark) + "\n" + text;
  if (!text.ends_with('\n')) text += '\n';
  if (!has_section) text += result.section;
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
  write_section(options, result, rig && rig->imported);
  return 0;
}

}  // namespace

void add_import(CLI::App& app, int& status) {
  auto o = std::make_shared<ImportOptions>();
  CLI::App* verb =
      app.add_subcommand("import", "what is understood of a foreign recording: columns, units, times, gaps");
  verb->add_option("FILE", o->recording, "a table of any logger, .csv or .csv.gz")->required();
  verb->add_option("CONFIG", o->config, "rig whose ranges and physics doubt the recording");
  verb->add_option("--report", o->report, "self-contained HTML page with the channels over time");
  verb->add_option("--json", o->json, "result as JSON, - for standard output");
  verb->add_option("--write", o->write, "OUT.yaml: the config with a section import, or the section alone");
  verb->add_flag("--force", o->force, "replaces an older result of import");
  add_set_option(*verb, o->sets);
  verb->footer("Quantities and units are guessed from names, brackets and a row of units; each line says by what.");
  verb->callback([o, &status] { status = run_import(*o); });
}

}  // namespace pneuservo
