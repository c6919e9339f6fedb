// The plots of the verb `run`.
#include <report/run_plots.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <report/run_summary.hpp>

namespace pneuservo {
namespace {

/// Points that all curves of a page share; some 14 bytes each keep it well below 3 MB.
constexpr std::size_t points_of_run = 150000;

bool has_values(const RunResult& run, RowColumn column) {
  return std::any_of(run.rows.begin(), run.rows.end(), [&](const Row& row) { return std::isfinite(column.of(row)); });
}

/// NaN aside.
bool keeps_one_value(const RunResult& run, std::size_t term) {
  double value = Row::none;
  for (const Row& row : run.rows) {
    if (std::isfinite(value) && std::isfinite(row.terms[term]) && row.terms[term] != value) return false;
    if (std::isfinite(row.terms[term])) value = row.terms[term];
  }
  return true;
}

/// A curve of value(row); nothing where no row has one.
template <class Value>
void add_curve(Plot& plot, const RunResult& run, std::string name, Tone tone, bool dashed, Value&& value) {
  Curve curve{std::move(name), tone, {}, {}, dashed, false};
  curve.x.reserve(run.rows.size());
  curve.y.reserve(run.rows.size());
  bool any = false;
  for (const Row& row : run.rows) {
    curve.x.push_back(row.t_s - run.start_s);
    curve.y.push_back(value(row));
    any = any || std::isfinite(curve.y.back());
  }
  if (any) plot.curves.push_back(std::move(curve));
}

/// The first row that carries the fault flag, else the last one of a run that names a fault.
void add_fault_mark(Plot& plot, const RunReport& report, const RunResult& run) {
  auto row = std::find_if(run.rows.begin(), run.rows.end(), [](const Row& r) { return (r.flags & row_fault) != 0; });
  if (row == run.rows.end() && (run.faults.empty() || run.rows.empty())) return;
  if (row == run.rows.end()) --row;
  plot.marks.push_back(
      {row->t_s - run.start_s, report.runs.size() > 1 ? fmt::format("fault, {}", run_label(report, run)) : "fault"});
}

Plot time_plot(const RunReport& report, std::string title, std::string unit, double period_s) {
  Plot plot;
  plot.title = std::move(title);
  plot.unit = std::move(unit);
  plot.x_step = period_s;
  const std::size_t curves = 12 * std::max<std::size_t>(1, shown_runs(report).size());
  plot.points_max = std::clamp<std::size_t>(points_of_run / curves, 500, 4000);
  return plot;
}

void add_window(Plot& plot, const Metrics& metrics) {
  if (std::isfinite(metrics.from_s) && metrics.to_s > metrics.from_s) plot.windows = {{metrics.from_s, metrics.to_s}};
}

/// Runs of one source share a colour; all but its last move are dashed.
bool is_dashed(const RunReport& report, const RunResult& run) {
  return std::any_of(report.runs.begin(), report.runs.end(), [&](const RunResult& other) {
    return other.pressure_source == run.pressure_source &&
           (other.move > run.move || (other.move == run.move && &other > &run));
  });
}

double true_or_measured_x(const RunResult& run, const Row& row) {
  return run.metrics.position_is_true ? row.x_true_m : row.measured[Signal::x];
}

/// 8 bins an octave: wide enough to be read, narrow enough to show a tail.
Curve histogram_curve(const char* name, Tone tone, const TimeHistogram& times) {
  constexpr int joined = TimeHistogram::bins_per_octave / 8;
  Curve curve{name, tone, {}, {}, false, true};
  std::vector<double> counts;
  for (int bin = 0; bin < TimeHistogram::bins; bin += joined) {
    double count = 0.0;
    for (int k = bin; k < bin + joined; ++k) count += static_cast<double>(times.bin_count(k));
    counts.push_back(count);
  }
  const auto any = [](double count) { return count > 0.0; };
  const auto first = std::find_if(counts.begin(), counts.end(), any) - counts.begin();
  const auto last = counts.rend() - std::find_if(counts.rbegin(), counts.rend(), any);
  constexpr double empty = 0.5;  // below one count: the foot of a logarithmic axis
  for (auto i = std::max<std::ptrdiff_t>(first - 1, 0); i <= last; ++i) {
    curve.x.push_back(TimeHistogram::upper_us(static_cast<int>(i) * joined - 1));
    curve.y.push_back(i < last ? std::max(empty, counts[static_cast<std::size_t>(i)]) : empty);
  }
  return curve;
}

}  // namespace

Tone tone_of(const std::string& pressure_source) {
  if (pressure_source == "valve") return Tone::valve;
  if (pressure_source == "chamber") return Tone::chamber;
  if (pressure_source == "estimated") return Tone::estimated;
  return Tone::fourth;
}

std::vector<const RunResult*> shown_runs(const RunReport& report) {
  std::vector<const RunResult*> shown;
  for (const RunResult& run : report.runs) {
    bool first = true, last = true;
    for (const RunResult& other : report.runs) {
      if (other.pressure_source != run.pressure_source || other.feedforward != run.feedforward) continue;
      first = first && other.move >= run.move;
      last = last && other.move <= run.move;
    }
    if (report.runs.size() <= 6 || first || last) shown.push_back(&run);
  }
  return shown;
}

Plot position_plot(const RunReport& report, double period_s) {
  Plot plot = time_plot(report, "Position", "mm", period_s);
  const auto runs = shown_runs(report);
  if (!runs.empty()) {
    // The longest run has the whole reference; a fault may have cut the others.
    const RunResult& longest =
        **std::max_element(runs.begin(), runs.end(), [](auto* a, auto* b) { return a->rows.size() < b->rows.size(); });
    add_curve(plot, longest, "reference", Tone::neutral, true, [](const Row& row) { return 1e3 * row.x_ref_m; });
    add_window(plot, longest.metrics);
  }
  for (const RunResult* run : runs) {
    add_curve(plot, *run, run_label(report, *run), tone_of(run->pressure_source), is_dashed(report, *run),
              [&](const Row& row) { return 1e3 * true_or_measured_x(*run, row); });
    add_fault_mark(plot, report, *run);
  }
  return plot;
}

Plot position_error_plot(const RunReport& report, double period_s) {
  const LengthUnit unit = error_unit(report);
  Plot plot = time_plot(report, "Position error", unit.name, period_s);
  for (const RunResult* run : shown_runs(report)) {
    add_curve(plot, *run, run_label(report, *run), tone_of(run->pressure_source), is_dashed(report, *run),
              [&](const Row& row) { return unit.per_m * (row.x_ref_m - true_or_measured_x(*run, row)); });
    add_fault_mark(plot, report, *run);
    add_window(plot, run->metrics);
  }
  return plot;
}

Plot deviation_plot(const RunReport& report, double period_s) {
  const LengthUnit unit = error_unit(report);
  Plot plot = time_plot(report, "Deviation from the predicted motion", unit.name, period_s);
  for (const RunResult* run : shown_runs(report)) {
    if (!has_values(*run, &Row::x_predicted_m)) continue;
    add_curve(plot, *run, run_label(report, *run), tone_of(run->pressure_source), is_dashed(report, *run),
              [&](const Row& row) { return unit.per_m * (row.measured[Signal::x] - row.x_predicted_m); });
    add_fault_mark(plot, report, *run);
    if (!plot.bands.empty() || !std::isfinite(run->deviation_limit_m)) continue;
    const double most = unit.per_m * run->deviation_limit_m;
    plot.bands.push_back({"limits.deviation_m",
                          Tone::neutral,
                          {run->rows.front().t_s - run->start_s, run->rows.back().t_s - run->start_s},
                          {-most, -most},
                          {most, most}});
  }
  return plot;
}

Plot command_plot(const RunReport& report, double period_s) {
  Plot plot = time_plot(report, "Valve command", "V", period_s);
  for (const RunResult* run : shown_runs(report)) {
    if (has_values(*run, &Row::u1_V)) {
      add_curve(plot, *run, run_label(report, *run) + ", valve 1", Tone::valve, is_dashed(report, *run),
                [](const Row& row) { return row.u1_V; });
      add_curve(plot, *run, run_label(report, *run) + ", valve 2", Tone::chamber, is_dashed(report, *run),
                [](const Row& row) { return row.u2_V; });
    } else {
      add_curve(plot, *run, run_label(report, *run), tone_of(run->pressure_source), is_dashed(report, *run),
                [](const Row& row) { return row.u_V; });
    }
    add_fault_mark(plot, report, *run);
  }
  return plot;
}

Plot pressure_plot(const RunReport& report, const RunResult& run, int side, double period_s) {
  const bool one = side == 1;
  const RowColumn port = one ? Signal::p1_port : Signal::p2_port,
                  measured = one ? Signal::p1_chamber : Signal::p2_chamber;
  const RowColumn truth = one ? &Row::p1_chamber_true_Pa : &Row::p2_chamber_true_Pa;
  const RowColumn estimated = one ? &Row::p1_estimated_Pa : &Row::p2_estimated_Pa;
  Plot plot = time_plot(report, fmt::format("Pressures of chamber {}", side), "kPa", period_s);
  const auto add = [&](const char* name, Tone tone, bool dashed, RowColumn column) {
    add_curve(plot, run, name, tone, dashed, [&](const Row& row) { return 1e-3 * column.of(row); });
  };
  add("valve port", Tone::valve, false, port);
  if (has_values(run, truth)) add("chamber, true", Tone::chamber, false, truth);
  else add("chamber, measured", Tone::chamber, false, measured);
  add("chamber, estimated", Tone::estimated, true, estimated);
  add_fault_mark(plot, report, run);
  return plot;
}

Plot estimation_error_plot(const RunReport& report, const RunResult& run, int side, double period_s) {
  const bool one = side == 1;
  const RowColumn truth = one ? &Row::p1_chamber_true_Pa : &Row::p2_chamber_true_Pa;
  const RowColumn estimated = one ? &Row::p1_estimated_Pa : &Row::p2_estimated_Pa;
  const RowColumn bound = one ? &Row::p1_bound_Pa : &Row::p2_bound_Pa;
  const bool is_true = has_values(run, truth);
  const RowColumn chamber = is_true ? truth : one ? Signal::p1_chamber : Signal::p2_chamber;
  Plot plot = time_plot(report, fmt::format("Estimation error of chamber {}", side), "kPa", period_s);
  plot.height_px = 190;
  add_curve(plot, run, is_true ? "estimated − true" : "estimated − measured", Tone::estimated, false,
            [&](const Row& row) { return 1e-3 * (estimated.of(row) - chamber.of(row)); });
  if (has_values(run, bound)) {
    Band band{"stated bound", Tone::neutral, {}, {}, {}};
    for (const Row& row : run.rows) {
      band.x.push_back(row.t_s - run.start_s);
      band.low.push_back(-1e-3 * bound.of(row));
      band.high.push_back(1e-3 * bound.of(row));
    }
    plot.bands.push_back(std::move(band));
  }
  add_window(plot, run.metrics);
  add_fault_mark(plot, report, run);
  return plot;
}

std::vector<Plot> term_plots(const RunReport& report, const RunResult& run, std::span<const LawTerm> terms,
                             double period_s) {
  constexpr std::array tones{Tone::valve, Tone::estimated, Tone::chamber, Tone::fourth, Tone::fifth, Tone::sixth};
  std::vector<Plot> plots;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (keeps_one_value(run, i)) continue;
    const auto is_of_unit = [&](const Plot& plot) { return plot.unit == terms[i].unit; };
    auto plot = std::find_if(plots.begin(), plots.end(), is_of_unit);
    if (plot == plots.end()) {
      const std::string unit(terms[i].unit);
      plots.push_back(time_plot(report, unit.empty() ? "Limits that acted" : "Terms in " + unit, unit, period_s));
      plots.back().height_px = 190;
      add_fault_mark(plots.back(), report, run);
      plot = plots.end() - 1;
    }
    add_curve(*plot, run, std::string(terms[i].name), tones[plot->curves.size() % tones.size()],
              plot->curves.size() >= tones.size(), [i](const Row& row) { return row.terms[i]; });
  }
  return plots;
}

Plot latency_plot(const RunResult& run) {
  Plot plot;
  plot.title = "Distribution of times";
  plot.unit = "cycles";
  plot.x_title = "time";
  plot.x_unit = "µs";
  plot.group.clear();
  plot.log_x = plot.log_y = true;
  plot.height_px = 280;
  const LoopTiming& timing = *run.timing;
  const auto add = [&](const char* name, Tone tone, const TimeHistogram& times) {
    if (times.count() > 0) plot.curves.push_back(histogram_curve(name, tone, times));
  };
  add("lateness", Tone::sixth, timing.lateness);
  add("backend", Tone::valve, timing.backend);
  add("estimator", Tone::estimated, timing.estimator);
  add("controller", Tone::chamber, timing.controller);
  add("loop", Tone::fourth, timing.loop);
  return plot;
}

std::vector<BarChart> figure_bars(const RunReport& report) {
  struct Figure {
    const char *title, *unit;
    double Metrics::* member;
    double scale;
  };
  constexpr Figure figures[] = {{"Position error, rms", "mm", &Metrics::rms_position_error_m, 1e3},
                                {"Position error, max", "mm", &Metrics::max_position_error_m, 1e3},
                                {"Position error at the end, size", "mm", &Metrics::end_error_m, 1e3},
                                {"Estimation error, rms", "kPa", &Metrics::rms_estimation_error_Pa, 1e-3},
                                {"Chamber pressure ripple", "kPa", &Metrics::chamber_pressure_ripple_Pa, 1e-3},
                                {"Command step, rms", "mV", &Metrics::command_step_rms_V, 1e3}};
  std::vector<BarChart> charts;
  for (const Figure& each : figures) {
    BarChart chart{each.title, each.unit, {}};
    for (const RunResult* run : shown_runs(report))
      chart.bars.push_back(
          {run_label(report, *run), tone_of(run->pressure_source), std::fabs(run->metrics.*each.member) * each.scale});
    charts.push_back(std::move(chart));
  }
  return charts;
}

}  // namespace pneuservo
