// Verb index: does this axis need the pipeline model? The thesis' tables 4.2 and 4.3 with --table.
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "index/index_report.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/result_file.hpp"

namespace pneuservo {

namespace {
struct IndexOptions {
  std::string config, report, json;
  std::vector<std::string> sets;
  bool table = false;
};

void print(const IndexOptions& options, const std::string& text, const nlohmann::ordered_json& json,
           const std::string& html) {
  if (options.json == "-") std::printf("%s\n", json.dump(2).c_str());
  else std::fputs(text.c_str(), stdout);
  if (!options.json.empty() && options.json != "-") write_result(options.json, json.dump(2) + "\n");
  if (!options.report.empty()) write_result(options.report, html);
}

void run_index(const IndexOptions& options) {
  if (options.table == !options.config.empty()) throw InputError("index: expected either a CONFIG or --table");
  OutputFiles()
      .reads("CONFIG", options.config)
      .writes("--report", options.report, ResultKind::page)
      .writes("--json", options.json, ResultKind::json);
  if (options.table) return print(options, index_table_text(), index_table_json(), index_table_html());
  const Rig rig = read_rig(options.config, options.sets);
  require_valves("index", options.config, rig, 1);
  try {
    const RigNecessity result = rig_necessity(rig);
    print(options, index_text(rig.name, result), index_json(rig.name, result), index_html(rig.name, result));
  } catch (const std::invalid_argument& error) { throw InputError(options.config + ": " + error.what()); }
}
}  // namespace

void add_index(CommandLine& app, int&) {
  auto options = std::make_shared<IndexOptions>();
  Verb verb = app.add_verb("index", "necessity of the pipeline model: line loss at peak speed over 10 kPa");
  verb.add_option("CONFIG", options->config, "rig to judge");
  add_set_option(verb, options->sets);
  verb.add_flag("--table", options->table, "the thesis' tables 4.2 and 4.3, printed digits beside ours");
  verb.add_option("--report", options->report, "self-contained HTML page with a map over length and diameter");
  verb.add_option("--json", options->json, "result as JSON with units in the keys; - for standard output");
  verb.callback([options] { run_index(*options); });
}

}  // namespace pneuservo
