// Verb import: what the program understands of a foreign recording, and the section of a config that says so.
#include <algorithm>
#include <iostream>
#include <memory>
#include <sstream>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/input_text.hpp"
#include "config/read_rig.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/result_file.hpp"
#include "report/import_report.hpp"

namespace pneuservo {
namespace {

struct ImportOptions {
  std::string recording, config, report, json, write;
  std::vector<std::string> sets;
  bool force = false;
};

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
    text = without_section(read_input_text(options.config, "a config file"));
    if (text.empty())
      throw InputError(options.config + ": found nothing when it was read again for --write, expected a file, no pipe");
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
  const ImportResult result = understand_recording(options.recording, rig);
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
