// The result of `run` in words and tables.
#include <report/run_summary.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <report/motion_verdict.hpp>
#include <report/pressure_report.hpp>

namespace pneuservo {
namespace {

struct Stage {
  const char* name;
  TimeHistogram LoopTiming::* times;
};
constexpr std::array<Stage, 5> stages{{{"lateness", &LoopTiming::lateness},
                                       {"loop", &LoopTiming::loop},
                                       {"estimator", &LoopTiming::estimator},
                                       {"controller", &LoopTiming::controller},
                                       {"backend", &LoopTiming::backend}}};

template <class Member> bool differs(const RunReport& report, Member member) {
  return std::any_of(report.runs.begin(), report.runs.end(),
                     [&](const RunResult& run) { return run.*member != report.runs.front().*member; });
}

template <class Function> auto collect(const RunReport& report, Function&& function) {
  std::vector<decltype(function(report.runs.front()))> values;
  for (const RunResult& run : report.runs) values.push_back(function(run));
  return values;
}

std::vector<double> scaled(const RunReport& report, double Metrics::* figure, double scale) {
  return collect(report, [&](const RunResult& run) { return run.metrics.*figure * scale; });
}

std::string source_words(const std::string& pressure_source) {
  if (pressure_source == "valve") return "the valve's port pressures";
  if (pressure_source == "none") return "no pressure fed back";
  if (pressure_source == "chamber") return "measured chamber pressures";
  if (pressure_source == "estimated") return "estimated chamber pressures";
  return pressure_source;
}

std::string capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

/// How a run is called in a sentence; `move` only where the report has several.
std::string run_words(const RunReport& report, const RunResult& run) {
  std::string words = source_words(run.pressure_source);
  if (differs(report, &RunResult::feedforward) && run.feedforward != "none")
    words += fmt::format(" and {} feedforward", run.feedforward);
  if (differs(report, &RunResult::move)) words += fmt::format(" in move {}", run.move);
  return words;
}

/// The best run without a fault of every other pressure source, and of every other feedforward of the best one's
/// source, to be set beside the best of all.
std::vector<const RunResult*> rivals(const RunReport& report, const RunResult& best) {
  std::vector<const RunResult*> found;
  const auto are_alike = [&](const RunResult& a, const RunResult& b) {
    return a.pressure_source == b.pressure_source &&
           (a.pressure_source != best.pressure_source || a.feedforward == b.feedforward);
  };
  for (const RunResult& run : report.runs) {
    const bool has_figures = run.faults.empty() && std::isfinite(run.metrics.rms_position_error_m);
    if (are_alike(run, best) || !has_figures) continue;
    const auto same = std::find_if(found.begin(), found.end(), [&](auto* other) { return are_alike(*other, run); });
    if (same == found.end()) found.push_back(&run);
    else if (run.metrics.rms_position_error_m < (*same)->metrics.rms_position_error_m) *same = &run;
  }
  std::sort(found.begin(), found.end(),
            [](auto* a, auto* b) { return a->metrics.rms_position_error_m < b->metrics.rms_position_error_m; });
  return found;
}

/// Errors of a run, with their share of the amplitude.
std::string error_words(const RunResult& run) {
  const std::string share = share_words(run.verdict);
  return fmt::format("{} rms error, {} at most{}", length_words(run.metrics.rms_position_error_m),
                     length_words(run.metrics.max_position_error_m), share.empty() ? "" : ", " + share);
}

bool goes_well(const RunResult& run) {
  const bool along = run.verdict.following == Following::follows || run.verdict.following == Following::rests;
  return along && !run.verdict.oscillates && !run.verdict.touched_end_stop;
}

std::string best_words(const RunReport& report, const RunResult& best) {
  const Metrics& metrics = best.metrics;
  if (report.runs.size() == 1)
    return fmt::format("With {} {}: {}.{}", run_words(report, best), following_words(best.verdict), error_words(best),
                       trouble_words(best.verdict));
  const std::vector<const RunResult*> others = rivals(report, best);
  // Within a hundredth of each other neither is the better one.
  const bool tied = !others.empty() && others[0]->metrics.rms_position_error_m < 1.01 * metrics.rms_position_error_m;
  const bool well = goes_well(best);
  std::string text = capital(run_words(report, best));
  if (tied)
    text += fmt::format(" {} {}", well ? "hold the position as well as" : "come as close to the reference as",
                        run_words(report, *others[0]));
  else text += well ? " hold the position best" : " come closest to the reference";
  if (!well) text += ", " + following_words(best.verdict);
  text += ": " + error_words(best);
  const std::size_t first = tied ? 1 : 0;
  for (std::size_t i = first; i < others.size(); ++i)
    text += fmt::format("{}{} with {}",
                        i == first              ? "; against "
                        : i + 1 < others.size() ? ", "
                                                : " and ",
                        length_words(others[i]->metrics.rms_position_error_m), run_words(report, *others[i]));
  return text + (others.empty() ? "." : " (rms).");
}

/// What several runs did beside following, each under its name.
std::string troubles(const RunReport& report) {
  std::string text;
  if (report.runs.size() < 2) return text;
  for (const RunResult& run : report.runs)
    if (run.faults.empty()) text += trouble_words(run.verdict, fmt::format("With {} it", run_words(report, run)));
  return text;
}

/// Names of a run's faults without their meaning.
std::string fault_names(const RunResult& run) {
  std::string text;
  for (const std::string& fault : run.faults) text += (text.empty() ? "" : ", ") + fault.substr(0, fault.find(':'));
  return text;
}

std::string fault_words(const RunReport& report) {
  std::string text;
  for (const RunResult& run : report.runs) {
    if (run.faults.empty()) continue;
    const std::string when = std::isfinite(run.fault_s) ? fmt::format(" at t = {:.6g} s", run.fault_s) : "";
    text += fmt::format(" The run with {} ended in a fault{}: {}.{}", run_words(report, run), when, fault_names(run),
                        trouble_words(run.verdict));
  }
  return text.empty() ? text : text.substr(1);
}

}  // namespace

LengthUnit error_unit(const RunReport& report) {
  constexpr double large_m = 1e-4;
  const bool large = std::any_of(report.runs.begin(), report.runs.end(),
                                 [](const RunResult& run) { return !(run.metrics.max_position_error_m < large_m); });
  return large ? LengthUnit{"mm", 1e3} : LengthUnit{"µm", 1e6};
}

std::string run_label(const RunReport& report, const RunResult& run) {
  std::string label = run.pressure_source;
  if (differs(report, &RunResult::feedforward))
    label += fmt::format(", {} feedforward", run.feedforward == "none" ? "no" : run.feedforward);
  if (differs(report, &RunResult::move)) label += fmt::format(", move {}", run.move);
  return label;
}

int best_run(const RunReport& report) {
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    const RunResult& run = report.runs[i];
    if (!run.faults.empty() || !(run.metrics.rms_position_error_m < least)) continue;
    least = run.metrics.rms_position_error_m;
    best = static_cast<int>(i);
  }
  return best;
}

std::string headline(const RunReport& report) {
  if (is_of_pressure(report)) return pressure_headline(report);
  if (report.runs.empty()) return "No run was made.";
  const int best = best_run(report);
  const std::string faults = fault_words(report);
  if (best < 0) return faults.empty() ? "The runs were too short to be judged." : faults;
  const std::string words = best_words(report, report.runs[static_cast<std::size_t>(best)]);
  return (faults.empty() ? words : faults + " " + words) + troubles(report);
}

std::string circumstances(const RunReport& report) {
  double longest_s = 0.0;
  for (const RunResult& run : report.runs)
    longest_s = std::max(longest_s, static_cast<double>(run.ticks + run.overruns) * report.period_s);
  const bool whole = longest_s >= report.duration_s - report.period_s;
  std::string text =
      whole ? fmt::format("{} time, {:g} s", report.time, report.duration_s)
            : fmt::format("{} time, ended after {:.4g} of {:g} s", report.time, longest_s, report.duration_s);
  if (report.time == "simulated" && std::isfinite(report.realtime_factor))
    text += fmt::format(", {} times as fast as real time", figure(report.realtime_factor));
  if (std::isfinite(report.shown_from_s))
    text += fmt::format(", shown from t = {:.6g} s on (the recording has all)", report.shown_from_s);
  return text;
}

Table comparison_table(const RunReport& report) {
  Table table{"", {}, report.runs.size() > 1 ? best_run(report) : -1};
  auto& columns = table.columns;
  columns.push_back(text_column("pressure source", collect(report, [](auto& run) { return run.pressure_source; })));
  if (differs(report, &RunResult::feedforward))
    columns.push_back(text_column("feedforward", collect(report, [](auto& run) { return run.feedforward; })));
  if (differs(report, &RunResult::move))
    columns.push_back(count_column("move", collect(report, [](auto& run) { return std::int64_t{run.move}; })));
  const auto [unit, per_m] = error_unit(report);
  columns.push_back(figure_column("max position error", unit, scaled(report, &Metrics::max_position_error_m, per_m)));
  columns.push_back(figure_column("rms position error", unit, scaled(report, &Metrics::rms_position_error_m, per_m)));
  columns.push_back(figure_column("end error", unit, scaled(report, &Metrics::end_error_m, per_m), 5));
  columns.push_back(
      figure_column("max estimation error", "kPa", scaled(report, &Metrics::max_estimation_error_Pa, 1e-3)));
  columns.push_back(
      figure_column("rms estimation error", "kPa", scaled(report, &Metrics::rms_estimation_error_Pa, 1e-3)));
  columns.push_back(figure_column("ripple", "kPa", scaled(report, &Metrics::chamber_pressure_ripple_Pa, 1e-3)));
  columns.push_back(figure_column("command step", "mV", scaled(report, &Metrics::command_step_rms_V, 1e3)));
  columns.push_back(
      count_column("faults", collect(report, [](auto& run) { return static_cast<std::int64_t>(run.faults.size()); })));
  return table;
}

std::optional<Table> latency_table(const RunReport& report) {
  std::vector<std::string> labels, names;
  std::array<std::vector<double>, 4> times_us;
  for (const RunResult& run : report.runs) {
    if (!run.timing) continue;
    for (const Stage& stage : stages) {
      const TimeHistogram& times = (*run.timing).*stage.times;
      labels.push_back(run_label(report, run));
      names.emplace_back(stage.name);
      times_us[0].push_back(times.percentile_us(0.5));
      times_us[1].push_back(times.percentile_us(0.99));
      times_us[2].push_back(times.percentile_us(0.9999));
      times_us[3].push_back(times.maximum_us());
    }
  }
  if (labels.empty()) return std::nullopt;
  Table table;
  if (report.runs.size() > 1) table.columns.push_back(text_column("run", labels));
  table.columns.push_back(text_column("stage", names));
  table.columns.push_back(figure_column("p50", "µs", times_us[0], 2));
  table.columns.push_back(figure_column("p99", "µs", times_us[1], 2));
  table.columns.push_back(figure_column("p99.99", "µs", times_us[2], 2));
  table.columns.push_back(figure_column("max", "µs", times_us[3], 2));
  return table;
}

std::optional<Table> interruption_table(const RunReport& report) {
  std::vector<std::string> labels;
  std::array<std::vector<std::int64_t>, 4> counts;
  for (const RunResult& run : report.runs) {
    if (!run.timing) continue;
    labels.push_back(run_label(report, run));
    counts[0].push_back(run.ticks);
    counts[1].push_back(run.overruns);
    counts[2].push_back(run.timing->page_faults);
    counts[3].push_back(run.timing->context_switches_involuntary);
  }
  if (labels.empty()) return std::nullopt;
  Table table;
  table.columns.push_back(text_column("run", labels));
  table.columns.push_back(count_column("ticks", counts[0]));
  table.columns.push_back(count_column("overruns", counts[1]));
  table.columns.push_back(count_column("page faults", counts[2]));
  table.columns.push_back(count_column("involuntary context switches", counts[3]));
  return table;
}

std::optional<Table> worst_cycles_table(const RunResult& run, std::size_t count) {
  if (!run.timing) return std::nullopt;
  std::vector<WorstCycle> cycles(run.timing->worst.begin(), run.timing->worst.end());
  std::erase_if(cycles, [](const WorstCycle& cycle) { return cycle.tick < 0; });
  if (cycles.empty()) return std::nullopt;
  std::sort(cycles.begin(), cycles.end(), [](const WorstCycle& a, const WorstCycle& b) {
    return a.lateness_ns + a.work_ns > b.lateness_ns + b.work_ns;
  });
  cycles.resize(std::min(count, cycles.size()));
  std::vector<std::int64_t> ticks;
  std::vector<double> lateness_us, work_us;
  for (const WorstCycle& cycle : cycles) {
    ticks.push_back(cycle.tick);
    lateness_us.push_back(static_cast<double>(cycle.lateness_ns) * 1e-3);
    work_us.push_back(static_cast<double>(cycle.work_ns) * 1e-3);
  }
  Table table;
  table.columns.push_back(count_column("tick", ticks));
  table.columns.push_back(figure_column("lateness", "µs", lateness_us, 2));
  table.columns.push_back(figure_column("work", "µs", work_us, 2));
  return table;
}

std::string run_text(const RunReport& report) {
  std::string text = fmt::format("{}: {}\n{}\n\n", report.config, circumstances(report), headline(report));
  text += text_table(is_of_pressure(report) ? pressure_table(report) : comparison_table(report));
  for (const RunResult& run : report.runs)
    for (const std::string& fault : run.faults) text += fmt::format("fault ({}): {}\n", run_label(report, run), fault);
  if (const auto table = latency_table(report)) text += "\n" + text_table(*table);
  if (const auto table = interruption_table(report)) text += "\n" + text_table(*table);
  for (const RunResult& run : report.runs)
    if (const auto table = worst_cycles_table(run, 5))
      text += fmt::format("\nworst cycles ({})\n{}", run_label(report, run), text_table(*table));
  return text;
}

}  // namespace pneuservo
