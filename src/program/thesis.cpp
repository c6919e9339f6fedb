// Verb thesis: every table and figure of the thesis beside what this program gives.
#include <cstdio>
#include <filesystem>
#include <memory>

#include <unistd.h>

#include "config/input_error.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "thesis/groups.hpp"
#include "thesis/pictures.hpp"
#include "thesis/report.hpp"

namespace pneuservo {
namespace {

struct ThesisOptions {
  std::string configs = "config", only, report, json;
};

void tell_progress(std::size_t done, std::size_t all) {
  if (isatty(STDERR_FILENO) != 0)
    std::fprintf(stderr, "\r%zu of %zu rows%s", done, all, done == all ? "\r                  \r" : "");
  else if (done % 50 == 0) std::fprintf(stderr, "%zu of %zu rows\n", done, all);
}

int run_thesis(const ThesisOptions& options) {
  if (!std::filesystem::is_directory(options.configs))
    throw InputError(options.configs +
                     ": not a folder, expected that of the shipped configs; run the verb beside it or name it by "
                     "--configs");
  OutputFiles().writes("--report", options.report, ResultKind::page).writes("--json", options.json, ResultKind::json);
  const std::vector<ThesisGroup> groups = thesis_groups(options.only);
  if (groups.empty()) throw InputError("--only: no row's place holds '" + options.only + "', such as 'Table 2.5'");
  ThesisBench bench(options.configs);
  const std::vector<ThesisResult> results = compute_thesis(groups, bench, tell_progress);
  if (options.json != "-") std::fputs(thesis_text(results).c_str(), stdout);
  write_json(options.json, thesis_json(results));
  if (!options.report.empty()) thesis_page(results, bench).write(options.report);
  return thesis_counts(results).back() > 0 ? 1 : 0;
}

}  // namespace

void add_thesis(CommandLine& app, int& status) {
  auto options = std::make_shared<ThesisOptions>();
  Verb verb = app.add_verb("thesis", "every table and figure of the thesis beside ours, with the reason");
  verb.footer("Exit status 1: a row has moved, that is, ours is not what it is held to be.");
  verb.add_option("--only", options->only, "rows whose place holds this text, e.g. 'Table 2.5' or 'Fig 3.'");
  verb.add_option("--configs", options->configs, "folder of the shipped configs").shows_default();
  verb.add_option("--report", options->report, "self-contained HTML page with the thesis' pictures");
  verb.add_option("--json", options->json, "result as JSON; - for standard output");
  verb.callback([options, &status] { status = run_thesis(*options); });
}

}  // namespace pneuservo
