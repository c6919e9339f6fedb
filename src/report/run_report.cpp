// The page of the verb `run`.
#include <report/run_report.hpp>

#include <cmath>

#include <fmt/format.h>
#include <report/evaluation.hpp>
#include <report/html_page.hpp>
#include <report/pressure_report.hpp>
#include <report/run_plots.hpp>
#include <report/run_summary.hpp>

namespace pneuservo {
namespace {

std::string definitions(const RunReport& report) {
  const Metrics& metrics = report.runs.front().metrics;
  std::string text = "Errors are reference minus ";
  text += metrics.position_is_true ? "true position of the simulated plant" : "measured position";
  if (std::isfinite(metrics.from_s))
    text += fmt::format(", from {} s to {} s", figure(metrics.from_s), figure(metrics.to_s));
  return text +
         fmt::format(
             " (shaded in the plots). The end error is the mean over the last {:g} s. Estimation error: estimated "
             "minus true chamber pressure, the larger of both chambers. Ripple: peak to peak of a chamber's "
             "pressure above {:g} Hz. Command step: rms from one period to the next.",
             end_stretch_s, ripple_corner_Hz);
}

void add_figures(HtmlPage& page, const RunReport& report) {
  page.section("Figures", definitions(report));
  page.table(comparison_table(report));
  if (report.runs.size() > 1) page.bars(figure_bars(report));
  const std::size_t shown = shown_runs(report).size();
  if (shown < report.runs.size())
    page.paragraph(fmt::format("Bars and plots show the first and last move of each pressure source, {} of {} runs.",
                               shown, report.runs.size()));
}

void add_motion(HtmlPage& page, const RunReport& report, double period_s) {
  page.section("Motion", "Drag across a plot to zoom, shift and drag to pan, double-click to return; a click on a name "
                         "hides its curve. Thinned curves keep every peak.");
  page.plot(position_plot(report, period_s));
  page.plot(position_error_plot(report, period_s));
  const Plot deviation = deviation_plot(report, period_s);
  if (!deviation.curves.empty()) page.plot(deviation);
  page.plot(command_plot(report, period_s));
}

std::string term_words(std::span<const LawTerm> terms) {
  std::string text;
  for (const LawTerm& term : terms) text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", term.name, term.help);
  return text + ". A term that keeps one value is not drawn.";
}

/// Terms of the law, a run a panel.
void add_terms(HtmlPage& page, const RunReport& report, const Rig& rig) {
  const auto terms = law_terms(rig.controller.kind);
  page.section(fmt::format("Terms of the law {}", rig.controller.name()), term_words(terms));
  const auto runs = shown_runs(report);
  std::vector<std::string> names;
  for (const RunResult* run : runs) names.push_back(run_label(report, *run));
  page.panels_begin(names, runs.size() - 1);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    page.panel(i);
    for (const Plot& plot : term_plots(report, *runs[i], terms, rig.period_s)) page.plot(plot);
  }
  page.panels_end();
}

/// Pressures of one run at a time; the estimated source, in its last move, is seen first.
void add_pressures(HtmlPage& page, const RunReport& report, double period_s) {
  page.section("Pressures");
  const auto runs = shown_runs(report);
  std::vector<std::string> names;
  std::size_t selected = runs.size() - 1;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    names.push_back(run_label(report, *runs[i]));
    if (runs[i]->pressure_source == "estimated") selected = i;
  }
  page.panels_begin(names, selected);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    page.panel(i);
    for (const auto& make : {pressure_plot, estimation_error_plot}) {
      std::vector<Plot> row;
      for (int side : {1, 2}) {
        Plot plot = make(report, *runs[i], side, period_s);
        if (!plot.curves.empty()) row.push_back(std::move(plot));
      }
      if (!row.empty()) page.plots(row);
    }
  }
  page.panels_end();
}

void add_timing(HtmlPage& page, const RunReport& report) {
  const auto table = latency_table(report);
  if (!table) return;
  page.section("Timing",
               "Lateness is the wake-up against the ideal grid; loop is the loop's own work without estimator, "
               "controller and backend.");
  page.table(*table);
  if (const auto interruptions = interruption_table(report)) page.table(*interruptions);
  for (const RunResult& run : report.runs) {
    if (!run.timing) continue;
    Plot plot = latency_plot(run);
    if (report.runs.size() > 1) plot.title += ", " + run_label(report, run);
    if (!plot.curves.empty()) page.plot(plot);
    if (auto worst = worst_cycles_table(run, 8)) {
      worst->title = "Worst cycles" + (report.runs.size() > 1 ? ", " + run_label(report, run) : std::string());
      page.table(*worst);
    }
  }
}

HtmlPage make_page(const RunReport& report, const Rig& rig) {
  HtmlPage page(report.config + " · run", fmt::format("{} · {}", report.config, circumstances(report)),
                headline(report));
  for (const RunResult& run : report.runs)
    for (const std::string& fault : run.faults)
      page.alert(report.runs.size() > 1 ? fmt::format("Fault with {}: {}", run_label(report, run), fault) : fault);
  if (!report.runs.empty()) {
    if (is_of_pressure(report)) {
      add_pressure_sections(page, report, rig.period_s);
    } else {
      add_figures(page, report);
      add_motion(page, report, rig.period_s);
      add_pressures(page, report, rig.period_s);
    }
    add_terms(page, report, rig);
    add_timing(page, report);
  }
  page.section("Circumstances");
  if (!report.machine.empty()) page.details("Machine and build", report.machine);
  if (!report.channel_origins.empty()) page.details("Where the channels come from", report.channel_origins);
  if (!report.config_yaml.empty()) page.details("Config as it was used", report.config_yaml);
  return page;
}

}  // namespace

std::string run_report_html(const RunReport& report, const Rig& rig) { return make_page(report, rig).html(); }

void write_run_report(const RunReport& report, const Rig& rig, const std::string& path) {
  make_page(report, rig).write(path);
}

}  // namespace pneuservo
