// What the verb `improve` found and predicts, in words, as JSON and as a page.
#include <report/improvement.hpp>

#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <report/html_page.hpp>
#include <report/json_number.hpp>
#include <report/run_summary.hpp>

#include "config/dump_rig.hpp"
#include "config/rig_parameters.hpp"
#include "diagnosis/result_text.hpp"

namespace pneuservo {
namespace {

std::string mm(double error_m) { return fmt::format("{} mm", figure(1e3 * error_m)); }

bool is_predicted(const RunResult& run) { return std::isfinite(run.metrics.max_position_error_m); }

std::string fault_text(const RunResult& run) { return run.faults.empty() ? "" : "ended by " + run.faults.front(); }

/// Numbers that differ as they are written.
Table changes_table(const Improvement& improvement) {
  std::vector<std::string> paths, before, after;
  for (const ChangedNumber& change : improvement.changes) {
    if (value_text(change.before) == value_text(change.after)) continue;
    paths.push_back(change.path);
    before.push_back(value_text(change.before));
    after.push_back(value_text(change.after));
  }
  return {"", {text_column("key", paths), text_column("before", before), text_column("now", after)}};
}

Table errors_table(const Improvement& improvement) {
  std::vector<std::string> names, words;
  std::vector<double> largest_mm, rms_mm, end_mm;
  for (const auto& [name, run] :
       {std::pair{"as configured", &improvement.before}, std::pair{"improved", &improvement.after}}) {
    names.emplace_back(name);
    words.push_back(run->feedforward + (run->faults.empty() ? "" : ", " + fault_text(*run)));
    largest_mm.push_back(1e3 * run->metrics.max_position_error_m);
    rms_mm.push_back(1e3 * run->metrics.rms_position_error_m);
    end_mm.push_back(1e3 * run->metrics.end_error_m);
  }
  return {"",
          {text_column("config", names), text_column("feedforward", words),
           figure_column("largest error", "mm", largest_mm), figure_column("rms", "mm", rms_mm),
           figure_column("at the end", "mm", end_mm)}};
}

/// How it is tried, on the simulated machine and on the real one.
std::string trial_words(const Improvement& improvement) {
  const Rig& rig = improvement.improved;
  const std::string config = improvement.written.empty() ? "IMPROVED.yaml" : improvement.written;
  if (!rig.hal) return "pneuservo run " + config;
  return fmt::format("pneuservo check {0}, then pneuservo run {0} --hal configured --time real --record "
                     "after.csv.gz",
                     config);
}

Curve curve_of(const RunResult& run, const char* name, Tone tone, const std::function<double(const Row&)>& value) {
  Curve curve;
  curve.name = name;
  curve.tone = tone;
  for (const Row& row : run.rows) {
    if (row.t_s < run.start_s) continue;
    curve.x.push_back(row.t_s - run.start_s);
    curve.y.push_back(value(row));
  }
  return curve;
}

double error_mm(const Row& row) { return 1e3 * (row.x_ref_m - row.x_true_m); }

Plot plot_of(const Improvement& improvement, const char* title, const char* unit, std::vector<Curve> curves) {
  Plot plot;
  plot.title = title;
  plot.unit = unit;
  plot.x_step = improvement.improved.period_s;
  plot.curves = std::move(curves);
  if (const Metrics& judged = improvement.after.metrics; std::isfinite(judged.from_s))
    plot.windows.emplace_back(judged.from_s, judged.to_s);
  return plot;
}

void add_motion(HtmlPage& page, const Improvement& improvement) {
  page.section("Before and after",
               "The reference on the improved model, with sensor noise: with the config as it stood, and with the "
               "improved one. Errors are reference minus true position; the shaded stretch is judged. A real machine "
               "has what the model still lacks, too.");
  if (!is_predicted(improvement.before) && !is_predicted(improvement.after)) return;
  page.table(errors_table(improvement));
  const RunResult &before = improvement.before, &after = improvement.after;
  page.plot(plot_of(improvement, "Position error", "mm",
                    {curve_of(before, "as configured", Tone::chamber, error_mm),
                     curve_of(after, "improved", Tone::estimated, error_mm)}));
  page.plot(plot_of(improvement, "Position error, improved alone", "mm",
                    {curve_of(after, "improved", Tone::estimated, error_mm)}));
  const auto position_mm = [](const Row& row) { return 1e3 * row.x_true_m; };
  page.plot(plot_of(improvement, "Position", "mm",
                    {curve_of(after, "reference", Tone::neutral, [](const Row& row) { return 1e3 * row.x_ref_m; }),
                     curve_of(before, "as configured", Tone::chamber, position_mm),
                     curve_of(after, "improved", Tone::estimated, position_mm)}));
  const auto command_V = [](const Row& row) { return row.u_V; };
  page.plot(plot_of(improvement, "Command", "V",
                    {curve_of(before, "as configured", Tone::chamber, command_V),
                     curve_of(after, "improved", Tone::estimated, command_V)}));
}

}  // namespace

std::vector<ChangedNumber> changed_numbers(const Rig& before, const Rig& after) {
  std::vector<ChangedNumber> changes;
  for (const ParameterPath& now : parameter_paths(after)) {
    if (now.path.starts_with("controller.") || !has_parameter(before, now.path)) continue;
    if (const double was = get_parameter(before, now.path); was != now.value)
      changes.push_back({now.path, was, now.value});
  }
  return changes;
}

std::string improvement_headline(const Improvement& improvement) {
  if (improvement.is_refused) return "The improved config is refused: " + improvement.warnings.back() + ".";
  if (improvement.stopped) return "Stopped: this is what was found by then, and nothing is predicted.";
  const RunResult &before = improvement.before, &after = improvement.after;
  if (!improvement.without_pass.empty()) return "No command pass: " + improvement.without_pass + ".";
  if (!is_predicted(before))
    return fmt::format("With the improved config the axis errs by {} at most on the improved model.",
                       mm(after.metrics.max_position_error_m));
  return fmt::format("The largest error falls from {} to {} on the improved model.",
                     mm(before.metrics.max_position_error_m), mm(after.metrics.max_position_error_m));
}

std::string improvement_text(const Improvement& improvement) {
  std::string text = improvement.configured.name + ": what the recordings show\n";
  for (std::size_t i = 0; i < improvement.calls.size(); ++i)
    text += fmt::format("  call {}: {}\n", i + 1, improvement.calls[i].sentence);
  for (const std::string& warning : improvement.warnings) text += "warning: " + warning + "\n";
  if (improvement.changes.empty()) text += "no number of the config changes\n";
  else text += "\nwhat changes in the config:\n" + text_table(changes_table(improvement));
  if (is_predicted(improvement.before) || is_predicted(improvement.after))
    text += "\npredicted on the improved model:\n" + text_table(errors_table(improvement));
  text += "\n" + improvement_headline(improvement) + "\n";
  if (!improvement.written.empty()) text += "written: " + improvement.written + "\n";
  return text + "try it: " + trial_words(improvement) + "\n";
}

nlohmann::ordered_json improvement_json(const Improvement& improvement) {
  Json calls = Json::array(), changes = Json::object();
  for (const ImprovementCall& call : improvement.calls) {
    Json effects = Json::array();
    for (const DiagnosisAnswer& answer : call.answers) effects.push_back(answer.effect);
    calls.push_back({{"verdict", verdict_names[static_cast<std::size_t>(call.verdict)]},
                     {"effects", std::move(effects)},
                     {"sentence", call.sentence},
                     {"floors_left", call.floors_left}});
  }
  for (const ChangedNumber& change : improvement.changes)
    changes[change.path] = {{"before", change.before}, {"after", change.after}};
  const auto prediction = [](const RunResult& run) {
    return Json{{"feedforward", is_predicted(run) ? Json(run.feedforward) : Json(nullptr)},
                {"max_position_error_m", number(run.metrics.max_position_error_m)},
                {"rms_position_error_m", number(run.metrics.rms_position_error_m)},
                {"faults", run.faults}};
  };
  return {{"config", improvement.configured.name},
          {"calls", std::move(calls)},
          {"changes", std::move(changes)},
          {"warnings", improvement.warnings},
          {"without_pass", improvement.without_pass},
          {"predicted", {{"before", prediction(improvement.before)}, {"after", prediction(improvement.after)}}},
          {"written", improvement.written}};
}

void write_improvement_report(const Improvement& improvement, const std::string& path) {
  HtmlPage page("Improved " + improvement.configured.name, "pneuservo improve " + improvement.configured.name,
                improvement_headline(improvement));
  for (const std::string& warning : improvement.warnings) page.alert(warning + ".");
  page.section("What was found");
  for (std::size_t i = 0; i < improvement.calls.size(); ++i)
    page.paragraph(fmt::format("Call {}: {}", i + 1, improvement.calls[i].sentence));
  if (!improvement.changes.empty()) page.table(changes_table(improvement));
  add_motion(page, improvement);
  page.section("How to try it", trial_words(improvement) + ".");
  page.details("Improved config", dump_rig(improvement.improved));
  page.write(path);
}

}  // namespace pneuservo
