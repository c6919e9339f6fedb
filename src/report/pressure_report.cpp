// The result of `run` with a pressure rig.
#include <report/pressure_report.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <report/json_number.hpp>
#include <report/run_plots.hpp>
#include <report/run_summary.hpp>

namespace pneuservo {
namespace {

std::vector<double> figures(const RunReport& report, double PressureMetrics::* member, double scale) {
  std::vector<double> values;
  for (const RunResult& run : report.runs) values.push_back(scale * (*run.pressure).*member);
  return values;
}

std::string kPa(double value_Pa) { return figure(1e-3 * value_Pa) + " kPa"; }

std::string step_words(const PressureMetrics& m) {
  if (m.steps.empty()) return fmt::format("{} rms error, {} at most", kPa(m.rms_error_Pa), kPa(m.max_error_Pa));
  const std::string count = fmt::format("{} step{}", m.steps.size(), m.steps.size() > 1 ? "s" : "");
  const std::string beyond = fmt::format("{} % overshoot", figure(100.0 * m.max_overshoot_share));
  if (!std::isfinite(m.max_settling_s))
    return fmt::format("{}, {}: not every one settles within {:g} %", count, beyond, 100.0 * settled_share);
  return fmt::format("{}, {}, settled after {} s at the latest and {} off at most in the second half of each", count,
                     beyond, figure(m.max_settling_s), kPa(m.max_settled_error_Pa));
}

Plot pressure_course(const RunReport& report, double period_s) {
  Plot plot;
  plot.title = "Pressure in the volume";
  plot.unit = "kPa";
  plot.x_step = period_s;
  const auto add = [&](const RunResult& run, std::string name, Tone tone, bool dashed, RowColumn column) {
    Curve curve{std::move(name), tone, {}, {}, dashed, false};
    for (const Row& row : run.rows) {
      curve.x.push_back(row.t_s - run.start_s);
      curve.y.push_back(1e-3 * column.of(row));
    }
    if (std::ranges::any_of(curve.y, [](double y) { return std::isfinite(y); }))
      plot.curves.push_back(std::move(curve));
  };
  const auto runs = shown_runs(report);
  if (!runs.empty()) add(*runs.front(), "reference", Tone::neutral, true, &Row::p_ref_Pa);
  for (const RunResult* run : runs) {
    const std::string& source = run->pressure->pressure;
    const RowColumn column = source == "true"       ? RowColumn(&Row::p1_chamber_true_Pa)
                             : source == "measured" ? RowColumn(Signal::p1_chamber)
                                                    : RowColumn(&Row::p1_estimated_Pa);
    add(*run, run_label(report, *run) + ", " + source, tone_of(run->pressure_source), false, column);
  }
  return plot;
}

}  // namespace

bool is_of_pressure(const RunReport& report) { return !report.runs.empty() && report.runs.front().pressure; }

std::string pressure_headline(const RunReport& report) {
  std::string text;
  for (const RunResult& run : report.runs) {
    const PressureMetrics& m = *run.pressure;
    if (!text.empty()) text += " ";
    const std::string begin =
        report.runs.size() > 1 ? "With " + run_label(report, run) + ": " : "The pressure in the volume: ";
    if (!run.faults.empty())
      text += begin + fmt::format("the run ended by the fault {} at {} s.",
                                  run.faults.front().substr(0, run.faults.front().find(':')),
                                  figure(run.fault_s - run.start_s));
    else if (!std::isfinite(m.rms_error_Pa)) text += begin + "the run was too short to be judged.";
    else text += begin + step_words(m) + fmt::format(" ({} pressure).", m.pressure);
    if (std::isfinite(m.max_estimation_error_Pa))
      text += fmt::format(" The estimate is off by {} at most.", kPa(m.max_estimation_error_Pa));
  }
  return text;
}

Table pressure_table(const RunReport& report) {
  using M = PressureMetrics;
  Table table;
  std::vector<std::string> labels;
  std::vector<std::int64_t> faults;
  for (const RunResult& run : report.runs) {
    labels.push_back(run_label(report, run));
    faults.push_back(static_cast<std::int64_t>(run.faults.size()));
  }
  table.columns = {text_column("controlled pressure", labels),
                   figure_column("max error", "kPa", figures(report, &M::max_error_Pa, 1e-3)),
                   figure_column("rms error", "kPa", figures(report, &M::rms_error_Pa, 1e-3)),
                   figure_column("overshoot", "%", figures(report, &M::max_overshoot_share, 100.0)),
                   figure_column("settling", "s", figures(report, &M::max_settling_s, 1.0)),
                   figure_column("settled error", "kPa", figures(report, &M::max_settled_error_Pa, 1e-3)),
                   figure_column("max estimation error", "kPa", figures(report, &M::max_estimation_error_Pa, 1e-3)),
                   figure_column("rms estimation error", "kPa", figures(report, &M::rms_estimation_error_Pa, 1e-3)),
                   figure_column("command step", "mV", figures(report, &M::command_step_rms_V, 1e3)),
                   count_column("faults", faults)};
  return table;
}

nlohmann::ordered_json pressure_json(const PressureMetrics& m) {
  Json json;
  json["pressure"] = m.pressure;
  json["max_error_Pa"] = number(m.max_error_Pa);
  json["rms_error_Pa"] = number(m.rms_error_Pa);
  json["max_overshoot_share"] = number(m.max_overshoot_share);
  json["max_settling_s"] = number(m.max_settling_s);
  json["max_settled_error_Pa"] = number(m.max_settled_error_Pa);
  json["max_estimation_error_Pa"] = number(m.max_estimation_error_Pa);
  json["rms_estimation_error_Pa"] = number(m.rms_estimation_error_Pa);
  json["command_step_rms_V"] = number(m.command_step_rms_V);
  json["steps"] = Json::array();
  for (const PressureStep& step : m.steps)
    json["steps"].push_back({{"start_s", number(step.start_s)},
                             {"from_Pa", number(step.from_Pa)},
                             {"to_Pa", number(step.to_Pa)},
                             {"overshoot_share", number(step.overshoot_share)},
                             {"settling_s", number(step.settling_s)},
                             {"settled_error_Pa", number(step.settled_error_Pa)}});
  return json;
}

void add_pressure_sections(HtmlPage& page, const RunReport& report, double period_s) {
  page.section("Figures", fmt::format("Errors are reference minus {} pressure in the volume. A step has settled where "
                                      "{:g} % of its height are left no more; its settled error is the largest in "
                                      "the second half of its time. Estimation error: estimated less that "
                                      "pressure. Command step: rms from one period to the next.",
                                      report.runs.front().pressure->pressure, 100.0 * settled_share));
  page.table(pressure_table(report));
  page.section("Pressures", "Drag across a plot to zoom, shift and drag to pan, double-click to return; a click on a "
                            "name hides its curve.");
  page.plot(pressure_course(report, period_s));
  page.plot(command_plot(report, period_s));
  for (const RunResult* run : shown_runs(report)) {
    page.plot(pressure_plot(report, *run, 1, period_s));
    const Plot error = estimation_error_plot(report, *run, 1, period_s);
    if (!error.curves.empty()) page.plot(error);
  }
}

}  // namespace pneuservo
