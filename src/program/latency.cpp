// The verb latency: wake-up latency of the loop's own timer with nothing in it, and beside it the loop with a config.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "config/read_rig.hpp"
#include "loop/realtime_latency.hpp"
#include "loop/realtime_stop.hpp"
#include "loop/runner.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/import.hpp"
#include "record/result_file.hpp"
#include "report/run_json.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {
namespace {

using Json = nlohmann::ordered_json;
using Results = std::vector<std::unique_ptr<LatencyResult>>;

struct LatencyOptions {
  double period_us = 1000.0;
  LatencySettings settings;
  std::string config, json;
  bool period_stated = false;
};

/// A time [us] to the nanosecond, without the digits that binary fractions add.
double whole_ns(double time_us) { return std::round(time_us * 1e3) / 1e3; }

Json percentiles_json(const TimeHistogram& histogram) {
  Json percentiles;
  for (const auto& [name, quantile] : {std::pair{"p50", 0.5}, {"p99", 0.99}, {"p99_9", 0.999}, {"p99_99", 0.9999}})
    percentiles[name] = whole_ns(histogram.percentile_us(quantile));
  percentiles["max"] = whole_ns(histogram.maximum_us());
  percentiles["mean"] = whole_ns(histogram.mean_us());
  return percentiles;
}

Json as_json(const LatencyResult& result) {
  const LoopTiming& timing = result.timing;
  const RealTimeState& state = result.state;
  return {{"name", result.name},
          {"period_us", static_cast<double>(result.period_ns) * 1e-3},
          {"ticks", timing.ticks},
          {"overruns", timing.overruns},
          {"lateness_us", percentiles_json(timing.lateness)},
          {"loop_us", percentiles_json(timing.loop)},
          {"page_faults", timing.page_faults},
          {"context_switches_involuntary", timing.context_switches_involuntary},
          {"kernel", state.kernel},
          {"preempt_rt", state.preempt_rt},
          {"policy", state.policy},
          {"priority", state.priority},
          {"memory_locked", state.memory_locked},
          {"cpu_latency_held", state.cpu_latency_held},
          {"cpu", state.cpu ? Json(*state.cpu) : Json(nullptr)},
          {"lateness_histogram_us", histogram_json(timing.lateness)}};
}

/// One column a measurement, one line a number.
std::string as_text(const Results& results) {
  std::string text;
  const auto line = [&](std::string_view label, auto value) {
    text += fmt::format("{:<28}", label);
    for (const auto& result : results) text += fmt::format(" {:>14}", value(*result));
    text += '\n';
  };
  const auto percentile = [&](std::string_view label, double quantile) {
    line(label,
         [=](const LatencyResult& r) { return fmt::format("{:.2f}", r.timing.lateness.percentile_us(quantile)); });
  };
  line("", [](const LatencyResult& r) { return r.name; });
  line("period [us]",
       [](const LatencyResult& r) { return fmt::format("{:g}", static_cast<double>(r.period_ns) * 1e-3); });
  line("ticks", [](const LatencyResult& r) { return r.timing.ticks; });
  percentile("lateness p50 [us]", 0.5);
  percentile("lateness p99 [us]", 0.99);
  percentile("lateness p99.9 [us]", 0.999);
  percentile("lateness p99.99 [us]", 0.9999);
  line("lateness max [us]",
       [](const LatencyResult& r) { return fmt::format("{:.2f}", r.timing.lateness.maximum_us()); });
  line("loop's own work p99 [us]",
       [](const LatencyResult& r) { return fmt::format("{:.2f}", r.timing.loop.percentile_us(0.99)); });
  line("overruns (slots skipped)", [](const LatencyResult& r) { return r.timing.overruns; });
  line("page faults", [](const LatencyResult& r) { return r.timing.page_faults; });
  line("preemptions", [](const LatencyResult& r) { return r.timing.context_switches_involuntary; });
  line("policy", [](const LatencyResult& r) { return fmt::format("{} {}", r.state.policy, r.state.priority); });
  line("PREEMPT_RT kernel", [](const LatencyResult& r) { return r.state.preempt_rt ? "yes" : "no"; });
  return text;
}

void write_results(const std::string& path, const Results& results) {
  Json list = Json::array();
  for (const auto& result : results) list.push_back(as_json(*result));
  write_json(path, Json{{"runs", list}});
}

/// The loop of a config on its simulated plant, for the same time as the empty timer.
std::unique_ptr<LatencyResult> measure_loop(const LatencyOptions& options, Rig rig) {
  const bool ends = rig.duration_s < options.settings.duration_s;
  const int moves = ends ? static_cast<int>(std::ceil(options.settings.duration_s / rig.duration_s)) : 1;
  if (!ends) rig.duration_s = std::max(options.settings.duration_s, rig.period_s);
  auto result = std::make_unique<LatencyResult>();
  const RealTimeSession session(options.settings.session);
  SimBackend backend(rig);
  backend.configure();
  const RunOutcome outcome =
      run_loop(rig, backend, {.real_time = true, .moves = moves, .load = load_reference_positions});
  for (const auto& fault : outcome.faults) std::cerr << "fault: " << fault << "\n";
  *result = {rig.name, std::llround(rig.period_s * 1e9), *outcome.timing, session.state(), session.findings()};
  return result;
}

int run_latency(LatencyOptions options) {
  OutputFiles().reads("CONFIG", options.config).writes("--json", options.json, ResultKind::json);
  std::optional<Rig> rig;
  if (!options.config.empty()) {
    rig = read_rig(options.config);
    require_loop("latency", options.config, *rig);
    if (!options.period_stated) options.period_us = rig->period_s * 1e6;  // the same grid for both
  }
  options.settings.period_ns = std::llround(options.period_us * 1e3);
  const StopRequest stop;
  Results results;
  results.push_back(measure_latency(options.settings));
  if (rig && !StopRequest::requested()) results.push_back(measure_loop(options, *rig));
  std::cerr << refusal_message(results.front()->findings);
  if (options.json != "-") std::cout << as_text(results);
  write_results(options.json, results);
  return 0;
}

}  // namespace

void add_latency(CommandLine& app, int& status) {
  auto options = std::make_shared<LatencyOptions>();
  Verb verb = app.add_verb("latency", "wake-up latency of the loop's own timer, beside the loop with a config");
  verb.add_option("CONFIG", options->config, "also run this rig's loop on its simulated plant, for the same time");
  const VerbOption period =
      verb.add_option("--period-us", options->period_us, "period of the timer [us]; with CONFIG its period_s")
          .within(20.0, 1e6)
          .shows_default();
  verb.add_option("--duration-s", options->settings.duration_s, "how long to measure [s]")
      .within(0.01, 1e6)
      .shows_default();
  verb.add_option("--cpu", options->settings.session.cpu, "processor to pin the timer's thread to");
  verb.add_option("--priority", options->settings.session.priority, "of SCHED_FIFO").within(1, 99).shows_default();
  verb.add_option("--json", options->json, "write the numbers and the histogram here; - is standard output");
  verb.footer("pneuservo latency config/cylinder-10m-7.65mm.yaml --duration-s 30");
  verb.callback([options, period, &status] {
    options->period_stated = period.count() > 0;
    status = run_latency(*options);
  });
}

}  // namespace pneuservo
