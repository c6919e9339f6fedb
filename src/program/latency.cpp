// The verb latency: wake-up latency of the loop's own timer with nothing in it.
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "config/input_error.hpp"
#include "loop/realtime_latency.hpp"
#include "loop/realtime_stop.hpp"
#include "program/verbs.hpp"

namespace pneuservo {
namespace {

using Json = nlohmann::ordered_json;
using Results = std::vector<std::unique_ptr<LatencyResult>>;

struct LatencyOptions {
  double period_us = 1000.0;
  LatencySettings settings;
  std::string json;
};

/// A time [us] to the nanosecond, without the digits that binary fractions add.
double whole_ns(double time_us) { return std::round(time_us * 1e3) / 1e3; }

/// Bins that are not empty, as [longest time of the bin in us, count].
Json histogram_json(const TimeHistogram& histogram) {
  Json bins = Json::array();
  for (int bin = 0; bin < TimeHistogram::bins; ++bin)
    if (histogram.bin_count(bin) > 0) bins.push_back({whole_ns(TimeHistogram::upper_us(bin)), histogram.bin_count(bin)});
  return bins;
}

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
    line(label, [=](const LatencyResult& r) { return fmt::format("{:.2f}", r.timing.lateness.percentile_us(quantile)); });
  };
  line("", [](const LatencyResult& r) { return r.name; });
  line("period [us]", [](const LatencyResult& r) { return fmt::format("{:g}", static_cast<double>(r.period_ns) * 1e-3); });
  line("ticks", [](const LatencyResult& r) { return r.timing.ticks; });
  percentile("lateness p50 [us]", 0.5);
  percentile("lateness p99 [us]", 0.99);
  percentile("lateness p99.9 [us]", 0.999);
  percentile("lateness p99.99 [us]", 0.9999);
  line("lateness max [us]", [](const LatencyResult& r) { return fmt::format("{:.2f}", r.timing.lateness.maximum_us()); });
  line("loop's own work p99 [us]", [](const LatencyResult& r) { return fmt::format("{:.2f}", r.timing.loop.percentile_us(0.99)); });
  line("overruns (slots skipped)", [](const LatencyResult& r) { return r.timing.overruns; });
  line("page faults", [](const LatencyResult& r) { return r.timing.page_faults; });
  line("preemptions", [](const LatencyResult& r) { return r.timing.context_switches_involuntary; });
  line("policy", [](const LatencyResult& r) { return fmt::format("{} {}", r.state.policy, r.state.priority); });
  line("PREEMPT_RT kernel", [](const LatencyResult& r) { return r.state.preempt_rt ? "yes" : "no"; });
  return text;
}

void write_json(const std::string& path, const Results& results) {
  Json list = Json::array();
  for (const auto& result : results) list.push_back(as_json(*result));
  const std::string text = Json{{"runs", list}}.dump(2) + "\n";
  if (path == "-") {
    std::cout << text;
    return;
  }
  std::ofstream file(path);
  file << text;
  if (!file.flush()) throw InputError(path + ": cannot be written");
}

int run_latency(LatencyOptions options) {
  options.settings.period_ns = static_cast<std::int64_t>(options.period_us * 1e3 + 0.5);
  const StopRequest stop;
  Results results;
  results.push_back(measure_latency(options.settings));
  std::cerr << refusal_message(results.front()->findings);
  if (options.json != "-") std::cout << as_text(results);
  if (!options.json.empty()) write_json(options.json, results);
  return 0;
}

}  // namespace

void add_latency(CLI::App& app, int& status) {
  auto options = std::make_shared<LatencyOptions>();
  CLI::App* verb = app.add_subcommand("latency", "wake-up latency of the loop's own timer with nothing in it");
  verb->add_option("--period-us", options->period_us, "period of the timer [us]")->check(CLI::Range(20.0, 1e6))->capture_default_str();
  verb->add_option("--duration-s", options->settings.duration_s, "how long to measure [s]")->check(CLI::Range(0.01, 1e6))->capture_default_str();
  verb->add_option("--cpu", options->settings.session.cpu, "processor to pin the timer's thread to");
  verb->add_option("--priority", options->settings.session.priority, "of SCHED_FIFO")->check(CLI::Range(1, 99))->capture_default_str();
  verb->add_option("--json", options->json, "write the numbers and the histogram here; - is standard output");
  verb->callback([options, &status] { status = run_latency(*options); });
}

}  // namespace pneuservo
