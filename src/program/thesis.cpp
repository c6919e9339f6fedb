// Verb thesis: every table and figure of the thesis beside what this program gives.
#include <cstdio>
#include <filesystem>
#include <memory>

#include <unistd.h>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "thesis/groups.hpp"
#include "thesis/one_set.hpp"
#include "thesis/pictures.hpp"
#include "thesis/report.hpp"

namespace pneuservo {
namespace {

struct ThesisOptions {
  std::string configs = "config", only, report, json, search;
  OneSetSearch trials;
  std::vector<std::string> figures;
  bool diagnose = false;
};

void tell_progress(std::size_t done, std::size_t all) {
  if (isatty(STDERR_FILENO) != 0)
    std::fprintf(stderr, "\r%zu of %zu rows%s", done, all, done == all ? "\r                  \r" : "");
  else if (done % 50 == 0) std::fprintf(stderr, "%zu of %zu rows\n", done, all);
}

const OneSet& set_of(const std::vector<OneSet>& sets, const std::string& name) {
  std::string names;
  for (const OneSet& set : sets) {
    if (set.name == name) return set;
    names += (names.empty() ? "" : ", ") + std::string(set.name);
  }
  throw InputError(fmt::format("--search: found '{}', expected one of {}", name, names));
}

OneSet asked_set(const ThesisOptions& options) {
  const std::vector<OneSet> sets = all_one_sets();
  const OneSet& set = set_of(sets, options.search);
  if (options.figures.empty()) return set;
  try {
    return with_figures(set, options.figures);
  } catch (const std::invalid_argument& e) { throw InputError(fmt::format("--figures: {}", e.what())); }
}

/// Prints the best set of a search beside the one that the page holds. Status 1: the search found a nearer one.
int search_thesis(const ThesisOptions& options) {
  const OneSet set = asked_set(options);
  if (options.trials.from_begun && set.begun.empty())
    throw InputError(fmt::format("--from-begun: found '{}', which has no member set by hand", set.name));
  ThesisBench bench(options.configs);
  const double held = total_deviation(set, figures_of(set, bench, found_numbers(set)));
  const OneSetFound found = search_one_set(set, options.configs, options.trials, [](const OneSetFound& now) {
    std::fprintf(stderr, "%zu tried, total deviation %.4f\n", now.evaluations, now.deviation);
  });
  fmt::print("{}: {} members of the family tried, seed {}\n", set.title, found.evaluations, options.trials.seed);
  for (std::size_t i = 0; i < set.numbers.size(); ++i)
    fmt::print("  {:<52} {:.9g} {} ({:g} to {:g})\n", set.numbers[i].name, found.at[i], set.numbers[i].unit,
               set.numbers[i].low, set.numbers[i].high);
  for (std::size_t i = 0; i < set.figures.size(); ++i)
    fmt::print("  {:<9} {:<44} printed {}, found {:.4g} {}\n", set.figures[i].place, set.figures[i].what,
               set.figures[i].printed, found.ours[i], set.figures[i].unit);
  fmt::print("total deviation {:.4f}, of the set on the page {:.4f}\n", found.deviation, held);
  return found.deviation < (1.0 - searched_within) * held ? 1 : 0;
}

int run_thesis(const ThesisOptions& options) {
  if (!std::filesystem::is_directory(options.configs))
    throw InputError(options.configs +
                     ": not a folder, expected that of the shipped configs; run the verb beside it or name it by "
                     "--configs");
  if (!options.search.empty()) return search_thesis(options);
  if (!options.figures.empty())
    throw InputError("--figures: found no --search, expected one of which these are figures");
  OutputFiles().writes("--report", options.report, ResultKind::page).writes("--json", options.json, ResultKind::json);
  const std::vector<ThesisGroup> groups = thesis_groups(options.only, options.diagnose);
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
  verb.add_flag("--diagnose", options->diagnose,
                "also what diagnose says that the linear models of 2.4 lack: takes minutes");
  verb.add_option("--configs", options->configs, "folder of the shipped configs").shows_default();
  verb.add_option("--report", options->report, "self-contained HTML page with the thesis' pictures");
  verb.add_option("--json", options->json, "result as JSON; - for standard output");
  verb.add_option("--search", options->search,
                  "search one set of numbers for many figures instead: lines, table, cylinder, line-0.5m, line-1m, "
                  "line-2m; status 1 where it finds a "
                  "nearer one than the page has");
  verb.add_option("--figures", options->figures, "figures that count in the search, e.g. 2.21 2.28; default: all");
  verb.add_option("--evaluations", options->trials.evaluations, "members of the family that the search tries")
      .shows_default();
  verb.add_option("--seed", options->trials.seed, "of the search").shows_default();
  verb.add_flag("--from-found", options->trials.from_found, "search about the set on the page alone");
  verb.add_flag("--from-begun", options->trials.from_begun,
                "search about the member that was set by hand, where the set has one");
  verb.callback([options, &status] { status = run_thesis(*options); });
}

}  // namespace pneuservo
